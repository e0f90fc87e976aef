// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/no_frame.h"

#include <cstdio>
#include <stdexcept>

#include "tools/ctl/status_message.h"

namespace disparityd::tools {

namespace {

// Programs that say every second why no frame came stay at that rate.
constexpr std::chrono::seconds patience_for_status{1};

}  // namespace

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

}  // namespace disparityd::tools
