// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "clients/places/connect_arguments.h"
#include "clients/places/daemon_sockets.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Says which daemon the command line means.
struct DaemonAddress {
    std::string socket;            ///< as the user typed it; empty = where a daemon listens by default
    std::string name = "default";  ///< of its shared memory

    clients::ConnectArguments reach;  ///< how, over TLS

    void add_to(CLI::App& app);

    /// Returns a command line that reaches the same daemon, for messages: "disparityctl status --name front".
    std::string command(const std::string& words) const;

    /// Returns the given address, or the default places where there is a socket. In folders that other users may write
    /// to, a socket must belong to this user or root. Throws std::invalid_argument when the given one has another form.
    clients::DaemonSockets sockets() const;
};

/// So long a daemon may take to answer, unless somebody asks for less.
constexpr std::chrono::milliseconds patience_to_connect = std::chrono::seconds(5);

/// Connects to the first address that answers. It skips sockets and processes of other users in default places, and
/// notes them. `timeout`: for each address. Throws std::runtime_error with one line: which places were tried, what to
/// do.
disparity::SocketClient connect(const DaemonAddress& daemon, std::chrono::milliseconds timeout = patience_to_connect);

}  // namespace disparityd::tools
