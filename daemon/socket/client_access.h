// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "base/access/tokens.h"
#include "daemon/socket/client_peer.h"

namespace disparityd::daemon {

/// A group of the system.
struct UserGroup {
    gid_t number = 0;
    std::string name;
};

/// Says which clients may look and which may control, as configured.
struct ClientAccess {
    bool tcp_control = false;                         ///< whoever may look over TCP may control
    bool encrypted = false;                           ///< clients over TCP must use TLS
    bool certificates = false;                        ///< clients over TCP must show a certificate
    base::Tokens tokens{};                            ///< clients over TCP must send one of them; empty: none is needed
    std::vector<std::string> control_certificates{};  ///< common names of certificates that may control
    std::vector<UserGroup> view_groups{};             ///< of the Unix socket; empty: whoever can open it may look
    std::vector<UserGroup> control_groups{};          ///< of the Unix socket; empty: whoever may look may control
    std::string unix_path{};                          ///< for messages; empty = off

    /// Returns whether a client over TCP has to show who it is.
    bool asks_over_tcp() const { return certificates || !tokens.empty(); }

    /// `token`: of the client's Hello; ignored on the Unix socket.
    base::Right right_of(const ClientPeer& peer, std::string_view token) const;

    /// Returns one line for a client without a right: why, what is allowed.
    std::string why_not_view(const ClientPeer& peer, std::string_view token) const;

    /// Returns one line for a client that may look only: why, what is allowed.
    std::string why_not_control(const ClientPeer& peer) const;
};

/// Finds the groups by name or number. Throws std::invalid_argument with one line, which begins with `key`, for a group
/// that this machine does not know, or that the daemon's user namespace hides (PrivateUsers= of its unit).
std::vector<UserGroup> find_groups(const std::vector<std::string>& names, const std::string& key);

/// Returns the groups of the process at the other end of a Unix socket, as they were when it connected.
std::vector<gid_t> groups_of_peer(int socket);

}  // namespace disparityd::daemon
