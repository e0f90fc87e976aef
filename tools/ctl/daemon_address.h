// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Which daemon is meant, as the command line says it.
struct DaemonAddress {
    std::string socket;            ///< as the user typed it; empty = where a daemon listens by default
    std::string name = "default";  ///< of its shared memory

    void add_to(CLI::App& app);

    /// The addresses to try, in order, as SocketClient takes them: the given one, or the default places.
    /// Throws std::invalid_argument when the given one has no known form.
    std::vector<std::string> sockets() const;
};

/// Connects to the first address that answers. Throws std::runtime_error with one line: where was tried, what to do.
disparity::SocketClient connect(const DaemonAddress& daemon);

/// Whether the address leads to this machine, as far as its text tells.
bool is_local(const std::string& socket);

}  // namespace disparityd::tools
