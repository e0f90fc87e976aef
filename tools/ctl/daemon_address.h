// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Says which daemon the command line means.
struct DaemonAddress {
    std::string socket;            ///< as the user typed it; empty = where a daemon listens by default
    std::string name = "default";  ///< of its shared memory

    void add_to(CLI::App& app);

    /// Returns a command line that reaches the same daemon, for messages: "disparityctl status --name front".
    std::string command(const std::string& words) const;

    struct Candidate {
        std::string address;      ///< as SocketClient takes it
        bool check_user = false;  ///< the listening process must be this user's or root's
    };
    struct Sockets {
        std::vector<Candidate> usable;     ///< in the order in which to try them
        std::vector<std::string> refused;  ///< one line each: which socket is not used, and why
    };

    /// Returns the given address, or the default places where there is a socket. In folders that other users may write
    /// to, a socket must belong to this user or root. Throws std::invalid_argument when the given one has another form.
    Sockets sockets() const;
};

/// Connects to the first address that answers. It skips sockets and processes of other users in default places, and
/// notes them. Throws std::runtime_error with one line: which places were tried, what to do.
disparity::SocketClient connect(const DaemonAddress& daemon);

/// Whether the address leads to this machine, by its text.
bool is_local(const std::string& socket);

}  // namespace disparityd::tools
