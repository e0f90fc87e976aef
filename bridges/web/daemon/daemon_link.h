// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::web {

/// Says which daemon is meant.
struct DaemonAddress {
    std::string name = "default";
    std::string socket;  ///< "tcp:HOST:PORT", "tls:HOST:PORT", "unix:PATH"; empty = where a daemon of this name listens
                         ///< by default

    disparity::ConnectOptions options{};

    /// Connects. `role` tells this program's connections apart in the daemon's status. Throws std::runtime_error with
    /// one line.
    disparity::SocketClient connect(const std::string& role) const;
};

/// Returns what the daemon said of itself when the client connected.
struct Welcome {
    std::string
        shared_memory;  ///< the name of its object, "default"; empty = there is none, or it is another machine's
    std::vector<disparity::Product> products;
};
Welcome welcome_of(const disparity::SocketClient& client);

}  // namespace disparityd::web
