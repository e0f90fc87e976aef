// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bridges/web/http/server_settings.h"

namespace disparityd::web {

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
