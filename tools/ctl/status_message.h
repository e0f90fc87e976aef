// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::tools {

/// Sends requests to the daemon and returns its answers as messages. Each throws std::runtime_error with one line: the
/// error of the client library or the daemon, or that the answer cannot be read.
v1::Status daemon_status(disparity::SocketClient& client, std::chrono::milliseconds limit = std::chrono::seconds(5));
v1::RecordStatus start_daemon_recording(disparity::SocketClient& client, const std::string& path,
                                        std::chrono::milliseconds limit);
v1::RecordStatus stop_daemon_recording(disparity::SocketClient& client);

/// Returns the newest status that came unasked (Subscription::status_interval_s); nothing when none came since the last
/// call.
std::optional<v1::Status> pushed_status(disparity::SocketClient& client);

v1::CameraControls control_daemon_camera(disparity::SocketClient& client,
                                         const std::vector<std::pair<std::string, std::int64_t>>& settings);

/// Takes a trace of so many seconds, 0.1 to 10, and waits for it.
v1::Trace trace_daemon(disparity::SocketClient& client, double seconds);

}  // namespace disparityd::tools
