// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "bridges/web/daemon/daemon_link.h"
#include "bridges/web/http/access.h"
#include "proto/tls/tls_context.h"

namespace disparityd::web {

struct ServerSettings {
    DaemonAddress daemon;
    bool all = false;                ///< all daemons of this machine instead of that one
    std::string host = "127.0.0.1";  ///< an address of this machine
    std::uint16_t port = 8765;       ///< 0 = any free one
    AccessRules access;
    proto::TlsFiles tls;  ///< without a certificate the server does not encrypt
    int max_connections = 128;
};

/// Lowers max_connections to what so many file descriptors allow. Returns one line that says so, "" where they are
/// enough. Throws std::runtime_error with one line where they are too few for any service.
std::string fit_to_descriptors(ServerSettings& settings, std::size_t descriptors);

}  // namespace disparityd::web
