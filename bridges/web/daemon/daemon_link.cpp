// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_link.h"

#include <chrono>
#include <stdexcept>
#include <string_view>

#include "clients/places/daemon_sockets.h"
#include "proto/disparity.pb.h"

namespace disparityd::web {

namespace {

/// A daemon that does not greet within this time is told to hang.
constexpr std::chrono::seconds greeting_patience{2};

}  // namespace

disparity::SocketClient DaemonAddress::connect(const std::string& role) const {
    const clients::DaemonSockets sockets =
        socket.empty() ? clients::default_sockets(name) : clients::DaemonSockets{{{socket}}, {}, false};
    return clients::connect(
        sockets, name, "disparity-web " + role, [](const std::string&) {}, greeting_patience, options);
}

Welcome welcome_of(const disparity::SocketClient& client) {
    v1::Welcome message;
    if (!message.ParseFromString(client.welcome())) {
        throw std::runtime_error("the daemon's greeting is damaged or of another version");
    }
    Welcome welcome;
    // Only a Unix socket surely leads to a daemon of this machine: a TCP port may be a tunnel.
    constexpr std::string_view prefix = "/disparityd.";
    const std::string& object = message.shared_memory();
    if (client.server_user() && object.compare(0, prefix.size(), prefix) == 0) {
        welcome.shared_memory = object.substr(prefix.size());
    }
    for (const int product : message.products()) {
        welcome.products.push_back(static_cast<disparity::Product>(product));
    }
    return welcome;
}

}  // namespace disparityd::web
