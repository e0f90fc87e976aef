// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "clients/command_line/daemon_arguments.h"
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

using clients::DaemonArguments;

/// So long a daemon may take to answer, unless somebody asks for less.
constexpr std::chrono::milliseconds patience_to_connect = std::chrono::seconds(5);

/// Connects as disparity::connect() does, and throws as it does. Sockets of other users that are left alone are noted.
/// `products`: of the frames that are wanted; none where only requests are sent.
disparity::Client connect(const DaemonArguments& daemon, const std::vector<disparity::Product>& products = {},
                          std::chrono::milliseconds timeout = patience_to_connect);

/// Returns the command of disparityctl that reaches the same daemon, for messages.
std::string command_of(const DaemonArguments& daemon, const std::string& words);

/// Returns why no frames come, from the daemon's status: "the daemon is preparing its source", "the source has ended
/// ..."; where the socket that frames come from does not answer, what is wrong with it; where no other socket answers,
/// the command that shows more. Takes up to 1 s to connect where the daemon hangs, and 1 s more if it hangs after that.
std::string why_no_frame(const DaemonArguments& daemon);

/// Returns whether the daemon answers and says that its source has ended: the newest frame is the last one.
bool source_has_ended(const DaemonArguments& daemon);

/// Returns "12.3 s".
std::string seconds_text(std::chrono::nanoseconds time);

}  // namespace disparityd::tools
