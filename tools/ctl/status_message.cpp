// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/status_message.h"

#include <stdexcept>

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

}  // namespace disparityd::tools
