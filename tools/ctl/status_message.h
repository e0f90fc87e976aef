// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::tools {

/// Requests to the daemon, their answers as messages. Throw std::runtime_error with one line: what the client library
/// or the daemon says, or that the answer makes no sense.
v1::Status daemon_status(disparity::SocketClient& client);
v1::RecordStatus start_daemon_recording(disparity::SocketClient& client, const std::string& path);
v1::RecordStatus stop_daemon_recording(disparity::SocketClient& client);

v1::CameraControls control_daemon_camera(disparity::SocketClient& client,
                                         const std::vector<std::pair<std::string, std::int64_t>>& settings);

}  // namespace disparityd::tools
