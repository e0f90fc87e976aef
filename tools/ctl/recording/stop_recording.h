// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::tools {

/// Asks the daemon to end its recording and waits until the file is closed. A signal that comes meanwhile
/// (catch_interrupts() with SecondSignal::is_kept) hastens this: the request is sent, and the program ends within a
/// second with exit_interrupted and a note, which names `stop`, the command for a daemon that has not done it.
/// Throws std::runtime_error with one line where the daemon refuses or does not answer in a minute.
v1::RecordStatus stop_recording_at_once(disparity::SocketClient& client, const std::string& stop);

}  // namespace disparityd::tools
