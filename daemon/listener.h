// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "daemon/client_session.h"

namespace disparityd {

/// An address that clients connect to, from when it is made, by any thread; they wait until serve(), and from then on
/// it belongs to the io_context's thread.
class Listener {
public:
    using Accepted = std::function<void(ClientSession::Socket socket, std::string address)>;

    virtual ~Listener() = default;

    /// Starts to accept.
    virtual void serve(Accepted accepted) = 0;

    /// Stops accepting; a Unix socket's file is removed.
    virtual void close() = 0;

    /// For people and programs: "tcp:127.0.0.1:9876", "unix:/run/disparityd/disparityd.sock".
    virtual std::string address() const = 0;
};

/// "ADDRESS:PORT" without a problem (socket_address.h). Throws std::runtime_error with one line naming address and key
/// when it is in use or the system refuses.
std::shared_ptr<Listener> make_tcp_listener(boost::asio::io_context& io, const std::string& address);

/// A file left over from a dead daemon is replaced, one that somebody serves at is refused, like everything that is not
/// a socket: std::runtime_error with one line.
std::shared_ptr<Listener> make_unix_listener(boost::asio::io_context& io, const std::string& path);

}  // namespace disparityd
