// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_link.h"

#include <chrono>

namespace disparityd::web {

disparity::Client DaemonAddress::connect(const std::string& role, const disparity::Subscription& wanted) const {
    disparity::ClientOptions to;
    to.client_name = "disparity-web " + role;
    to.timeout = std::chrono::seconds(2);  // a daemon that does not greet within this time hangs
    to.reach = options;
    return disparity::connect(where, wanted, to);
}

disparity::Subscription no_frames() {
    disparity::Subscription subscription;
    subscription.products.clear();
    return subscription;
}

}  // namespace disparityd::web
