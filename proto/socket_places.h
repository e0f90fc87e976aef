// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

/// Where daemons of this machine have their Unix sockets unless configured otherwise, and what the files are called.
/// Any thread may ask.
namespace disparityd::proto {

/// Returns the folders in which a daemon has its Unix socket by default: the first of them that it may write to. Only
/// root and the service may create files in the first one. Elsewhere another user may have put a socket, and a robot
/// would act on that user's frames.
std::vector<std::string> socket_folders();

/// Returns the file name of the socket of a daemon of this name in one of these folders.
std::string socket_file(const std::string& name, const std::string& folder);

/// Returns the name of the daemon whose socket is called so in this folder; nothing when it is another file.
std::optional<std::string> daemon_of_socket_file(const std::string& file, const std::string& folder);

/// Whether there is a socket, and one that this user may trust: its own, root's, or any in a folder `of_the_system`,
/// the first of those above. A link is none.
bool is_trusted_socket(const std::string& path, bool of_the_system);

/// Whether somebody takes connections of this user at a Unix socket, at once or after others. It connects and says
/// nothing.
bool somebody_listens(const std::string& path);

/// Whether nobody listens at a Unix socket, or there is none: its daemon was killed. It connects and says nothing;
/// where it may not connect, somebody is there.
bool nobody_listens(const std::string& path);

}  // namespace disparityd::proto
