// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "bridges/web/access.h"
#include "bridges/web/daemon_link.h"

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

/// Serves the page. One thread does the network, others read the daemon and encode.
class Server {
public:
    /// Listens. Throws std::runtime_error with one line: the address, the reason, what to do.
    explicit Server(const ServerSettings& settings);
    ~Server();

    /// Returns "http://127.0.0.1:8765/".
    std::string url() const;

    /// Serves until SIGTERM or SIGINT.
    void run();

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::web
