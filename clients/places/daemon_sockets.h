// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

/// Finds the socket of a daemon of this machine. disparityctl and the bridges share it; it is not installed.
namespace disparityd::clients {

/// Where a daemon listens when its configuration does not say otherwise.
inline constexpr const char* default_tcp = "tcp:127.0.0.1:9876";

/// Sockets that may lead to a daemon.
struct DaemonSockets {
    struct Candidate {
        std::string address;      ///< as SocketClient takes it
        bool check_user = false;  ///< the listening process must be this user's or root's
    };
    std::vector<Candidate> usable;     ///< in the order in which to try them
    std::vector<std::string> refused;  ///< one line each: which socket is not used, and why
    bool looked_for = true;            ///< in the default places; false: somebody has said which one
};

/// Returns the default places where there is a socket of a daemon of this name. In folders that other users may write
/// to, a socket must belong to this user or root. Throws std::invalid_argument where no daemon can have this name.
DaemonSockets default_sockets(const std::string& name);

/// Returns the address as SocketClient takes it: "tcp:HOST:PORT", "tls:HOST:PORT" and "unix:PATH" as they are, "/PATH"
/// as a Unix socket. Throws std::invalid_argument, which names --socket, when it has another form.
std::string socket_address(const std::string& text);

/// Connects to the first address that answers, and calls `note` with a line for each socket or process of another user
/// that was skipped. `timeout`: for each address. Throws std::runtime_error with one line: which places were tried,
/// which other daemons run, what to do.
disparity::SocketClient connect(const DaemonSockets& sockets, const std::string& daemon, const std::string& client_name,
                                const std::function<void(const std::string&)>& note,
                                std::chrono::milliseconds timeout = std::chrono::seconds(5),
                                const disparity::ConnectOptions& options = {});

}  // namespace disparityd::clients
