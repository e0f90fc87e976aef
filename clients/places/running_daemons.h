// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace disparityd::clients {

/// A name is also a part of file names. Throws std::invalid_argument, which names --name, where no daemon can have it.
void check_daemon_name(const std::string& name);

/// Returns the folders in which a daemon of this user, or of the system, has its Unix socket by default.
std::vector<std::string> socket_folders();

/// Returns the file name of the socket of a daemon in one of these folders.
std::string socket_file(const std::string& name, const std::string& folder);

/// Returns the names, in their order, of the daemons whose sockets in these folders somebody listens at. It only
/// connects: a daemon that hangs is among them.
std::vector<std::string> running_daemons();

}  // namespace disparityd::clients
