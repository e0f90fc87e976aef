// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/daemon.h"

#include <cstdio>
#include <stdexcept>

#include "tools/command_line/program.h"

namespace disparityd::tools {
namespace {

constexpr std::chrono::seconds patience{5};
/// Before a recording is closed, the frames that wait are written.
constexpr std::chrono::seconds patience_for_files{60};

template <typename Message>
Message parsed(const std::string& bytes) {
    Message message;
    if (!message.ParseFromString(bytes)) {
        throw std::runtime_error("the daemon's answer is damaged or of another version");
    }
    return message;
}

// Programs that say every second why no frame came stay at that rate.
constexpr std::chrono::seconds patience_for_status{1};

}  // namespace

v1::Status daemon_status(disparity::SocketClient& client, std::chrono::milliseconds limit) {
    return parsed<v1::Status>(client.status(limit));
}

v1::RecordStatus start_daemon_recording(disparity::SocketClient& client, const std::string& path,
                                        std::chrono::milliseconds limit) {
    return parsed<v1::RecordStatus>(client.start_recording(path, limit));
}

v1::RecordStatus stop_daemon_recording(disparity::SocketClient& client) {
    return parsed<v1::RecordStatus>(client.stop_recording(patience_for_files));
}

std::optional<v1::Status> pushed_status(disparity::SocketClient& client) {
    const std::string bytes = client.take_status();
    return bytes.empty() ? std::nullopt : std::optional(parsed<v1::Status>(bytes));
}

v1::CameraControls control_daemon_camera(disparity::SocketClient& client,
                                         const std::vector<std::pair<std::string, std::int64_t>>& settings) {
    return parsed<v1::CameraControls>(client.control_camera(settings, patience));
}

v1::Trace trace_daemon(disparity::SocketClient& client, double seconds) {
    return parsed<v1::Trace>(client.trace(seconds, patience_for_files));
}

std::string why_no_frame(const DaemonArguments& daemon) {
    try {
        disparity::Client client = connect(daemon, {}, patience_for_status);
        const v1::Status status = daemon_status(client.socket(), patience_for_status);
        if (!status.detail().empty()) {
            return status.detail();
        }
        if (status.state() != "running") {
            return "the daemon is " + status.state();
        }
    } catch (const std::runtime_error& error) {
        if (!daemon.socket.empty()) {
            return error.what();
        }
        // Frames may come over shared memory where no socket is known.
    }
    return command_of(daemon, "status") + " says more";
}

bool source_has_ended(const DaemonArguments& daemon) {
    try {
        disparity::Client client = connect(daemon, {}, patience_for_status);
        return daemon_status(client.socket(), patience_for_status).state() == "ended";
    } catch (const std::runtime_error&) {
        return false;  // frames may come over shared memory where no socket is known
    }
}

std::string seconds_text(std::chrono::nanoseconds time) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f s", std::chrono::duration<double>(time).count());
    return text;
}

disparity::Client connect(const DaemonArguments& daemon, const std::vector<disparity::Product>& products,
                          std::chrono::milliseconds timeout) {
    disparity::Subscription wanted;
    wanted.products = products;
    disparity::ClientOptions options = daemon.reach.for_client("disparityctl");
    options.timeout = timeout;
    options.note = print_note;
    return disparity::connect(daemon.where(), wanted, options);
}

std::string command_of(const DaemonArguments& daemon, const std::string& words) {
    return daemon.command("disparityctl " + words);
}

}  // namespace disparityd::tools
