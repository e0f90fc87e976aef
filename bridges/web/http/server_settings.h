// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "bridges/web/daemon/daemon_link.h"
#include "bridges/web/http/access.h"

namespace disparityd::web {

/// How the server encrypts. Empty names: it does not.
struct TlsFiles {
    std::string certificate;  ///< PEM, with the chain
    std::string key;          ///< PEM
    std::string authority;    ///< PEM; every client must have a certificate that one of these signed
    bool on() const { return !certificate.empty(); }
};

struct ServerSettings {
    DaemonAddress daemon;
    std::string host = "127.0.0.1";  ///< an address of this machine
    std::uint16_t port = 8765;       ///< 0 = any free one
    AccessRules access;
    TlsFiles tls;
    int max_connections = 128;
};

}  // namespace disparityd::web
