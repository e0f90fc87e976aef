// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "daemon/socket/client_peer.h"
#include "daemon/socket/client_session.h"

namespace disparityd::daemon {

/// An address that clients connect to. Any thread may make one; clients can connect at once and wait until serve().
/// From then on the io_context's thread owns it.
class Listener {
public:
    using Accepted = std::function<void(ClientSession::Socket socket, ClientPeer peer)>;

    virtual ~Listener() = default;

    /// Starts to accept.
    virtual void serve(Accepted accepted) = 0;

    /// Stops accepting; a Unix socket's file is removed.
    virtual void close() = 0;

    /// For people and programs: "tcp:127.0.0.1:9876", "unix:/run/disparityd/disparityd.sock".
    virtual std::string address() const = 0;

    /// Returns whether the address still leads here: a Unix socket's file may be removed or replaced. Any thread.
    virtual bool in_place() const { return true; }
};

/// "ADDRESS:PORT" without a problem (socket_address.h). Throws std::runtime_error with one line naming address and key
/// when it is in use or the system refuses.
std::shared_ptr<Listener> make_tcp_listener(boost::asio::io_context& io, const std::string& address);

/// Replaces the file of a daemon that no longer runs. Throws std::runtime_error with one line if a process serves at
/// the path, or if it is no socket.
std::shared_ptr<Listener> make_unix_listener(boost::asio::io_context& io, const std::string& path);

}  // namespace disparityd::daemon
