// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridges/web/http/http_session.h"
#include "bridges/web/http/server_settings.h"

namespace disparityd::web {

/// Takes connections on one port. The network's thread owns it.
class PortListener {
public:
    /// Throws std::runtime_error with one line.
    PortListener(const ServerSettings& settings, const Site& site);

    void start() { accept(); }
    void stop();
    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

private:
    void accept();
    void accept_after(std::chrono::milliseconds pause);
    template <typename Stream>
    void serve(Stream&& stream, const std::string& sender);

    Site site_;
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::steady_timer pause_;
    std::unique_ptr<boost::asio::ssl::context> tls_;  ///< nullptr: not encrypted
};

}  // namespace disparityd::web
