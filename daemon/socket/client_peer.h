// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

namespace disparityd::daemon {

/// The other end of a connection, as the system described it when the connection was accepted, and as it showed itself
/// in the TLS handshake.
struct ClientPeer {
    std::string address;                       ///< for people: "unix", "tcp:127.0.0.1:40000", "tls:127.0.0.1:40000"
    bool local = false;                        ///< connected to the Unix socket; the mode of its file says who may
    std::optional<uid_t> user;                 ///< of the process that connected to the Unix socket; unknown over TCP
    std::vector<gid_t> groups{};               ///< of that process, the supplementary ones too
    bool encrypted = false;                    ///< over TLS
    std::optional<std::string> certificate{};  ///< common name in its certificate, which was checked

    /// Returns whether it is the daemon's own user or root.
    bool owns_daemon() const { return local && user && (*user == geteuid() || *user == 0); }
};

}  // namespace disparityd::daemon
