// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_link.h"

#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include <unistd.h>

#include "proto/socket_places.h"

namespace disparityd::web {
namespace {

/// Where a daemon of this machine listens.
struct LocalSocket {
    std::string path;
    bool of_the_system = false;  ///< in a folder into which only root and the service put files
};

/// Returns the socket of a daemon of this name. Throws std::runtime_error with one line where nobody listens, or this
/// user may not connect.
LocalSocket socket_of(const std::string& name) {
    bool of_the_system = true;
    for (const std::string& folder : proto::socket_folders()) {
        const LocalSocket found{folder + '/' + proto::socket_file(name, folder), std::exchange(of_the_system, false)};
        if (!proto::is_trusted_socket(found.path, found.of_the_system) || proto::nobody_listens(found.path)) {
            continue;
        }
        if (access(found.path.c_str(), W_OK) != 0) {
            throw std::runtime_error("this user may not connect to " + found.path +
                                     ": put it into the socket's group, which the service gives to disparityd");
        }
        return found;
    }
    throw std::runtime_error("nobody listens at the socket of the daemon named " + name +
                             ": it was killed, or has crashed; start it again, or look into its log");
}

/// In a folder of all users the file's owner may have gone, and another user may have put one into its place.
void check_user(const disparity::SocketClient& client, const LocalSocket& socket) {
    const std::optional<unsigned> user = client.server_user();
    if (!socket.of_the_system && user && *user != getuid() && *user != 0) {
        throw std::runtime_error(socket.path + ": its process belongs to user " + std::to_string(*user) +
                                 ", neither to this user nor to root, so it is left alone");
    }
}

/// Frames come by the name alone, to have them from shared memory where that is. Over TCP it may be any daemon.
void check_way_of_frames(disparity::Client& client, const std::string& name) {
    const std::string way = client.where();
    if (way.rfind("shared memory", 0) != 0 && !client.socket().server_user()) {
        throw std::runtime_error("no daemon named " + name + " gives frames: who answers does so over TCP (" + way +
                                 "), where it may be another one, so it is left alone");
    }
}

}  // namespace

disparity::Client DaemonAddress::connect(const std::string& role, const disparity::Subscription& wanted) const {
    disparity::ClientOptions to;
    to.client_name = "disparity-web " + role;
    to.timeout = std::chrono::seconds(2);  // a daemon that does not greet within this time hangs
    to.reach = options;
    if (!by_unix_socket) {
        return disparity::connect(where, wanted, to);
    }
    if (!wanted.products.empty()) {
        disparity::Client client = disparity::connect(where, wanted, to);
        check_way_of_frames(client, where);
        return client;
    }
    const LocalSocket socket = socket_of(where);
    disparity::Client client = disparity::connect("unix:" + socket.path, wanted, to);
    check_user(client.socket(), socket);
    return client;
}

disparity::Subscription no_frames() {
    disparity::Subscription subscription;
    subscription.products.clear();
    return subscription;
}

}  // namespace disparityd::web
