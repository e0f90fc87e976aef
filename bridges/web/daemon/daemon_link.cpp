// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_link.h"

#include <chrono>
#include <stdexcept>

#include "proto/socket_places.h"

namespace disparityd::web {
namespace {

/// Throws std::runtime_error with one line where nobody listens at the sockets of this name. The client library would
/// look for daemons of other names then, and touch them all.
void check_listener(const std::string& name) {
    for (const std::string& folder : proto::socket_folders()) {
        if (!proto::nobody_listens(folder + '/' + proto::socket_file(name, folder))) {
            return;
        }
    }
    throw std::runtime_error("nobody listens at the socket of the daemon named " + name +
                             ": it was killed, or has crashed; start it again, or look into its log");
}

}  // namespace

disparity::Client DaemonAddress::connect(const std::string& role, const disparity::Subscription& wanted) const {
    disparity::ClientOptions to;
    to.client_name = "disparity-web " + role;
    to.timeout = std::chrono::seconds(2);  // a daemon that does not greet within this time hangs
    to.reach = options;
    if (by_unix_socket && wanted.products.empty()) {
        check_listener(where);
    }
    disparity::Client client = disparity::connect(where, wanted, to);
    if (by_unix_socket && wanted.products.empty() && !client.socket().server_user()) {
        throw std::runtime_error("no daemon answers at the Unix socket of " + where +
                                 "; one of another name listens at the usual TCP port");
    }
    return client;
}

disparity::Subscription no_frames() {
    disparity::Subscription subscription;
    subscription.products.clear();
    return subscription;
}

}  // namespace disparityd::web
