// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon_link.h"

#include <iostream>
#include <stdexcept>

#include "clients/places/daemon_sockets.h"
#include "proto/disparity.pb.h"

namespace disparityd::web {

disparity::SocketClient DaemonAddress::connect(const std::string& role) const {
    const clients::DaemonSockets sockets =
        socket.empty() ? clients::default_sockets(name) : clients::DaemonSockets{{{socket}}, {}};
    return clients::connect(sockets, name, "disparity-web " + role, [](const std::string&) {});
}

Welcome welcome_of(const disparity::SocketClient& client) {
    v1::Welcome message;
    if (!message.ParseFromString(client.welcome())) {
        throw std::runtime_error("the daemon's greeting is damaged or of another version");
    }
    Welcome welcome;
    // Only a Unix socket surely leads to a daemon of this machine: a TCP port may be a tunnel.
    if (client.server_user()) {
        welcome.shared_memory = message.shared_memory();
    }
    for (const int product : message.products()) {
        welcome.products.push_back(static_cast<disparity::Product>(product));
    }
    return welcome;
}

}  // namespace disparityd::web
