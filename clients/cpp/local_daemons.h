// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

/// Finds the daemons of this machine by their names.
namespace disparity {

/// Throws std::invalid_argument where no daemon can have this name.
void check_daemon_name(const std::string& name);

/// Maps the shared memory of a daemon that lives. Throws std::runtime_error with one line: there is none, it may not be
/// read, or its daemon gives no sign of life.
SharedMemoryReader open_memory_of(const std::string& name, const ClientOptions& options);

/// Connects to the first socket of a daemon of this name that answers. A socket or a process of another user is left
/// alone in a folder that other users may write to, and noted. `timeout`: for each socket. Throws std::runtime_error
/// with one line: which places were tried, which other daemons run, what to do.
SocketClient connect_to(const std::string& name, const ClientOptions& options, std::chrono::milliseconds timeout);

/// Returns the name of the daemon that runs on this machine: "default" where it runs, and where none does. Throws
/// std::runtime_error with one line that names them where several others run.
std::string running_daemon(const ClientOptions& options);

}  // namespace disparity
