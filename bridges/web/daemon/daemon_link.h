// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::web {

/// Says which daemon is meant.
struct DaemonAddress {
    std::string where = "default";  ///< as disparity::connect() takes it
    disparity::ConnectOptions options{};
    /// Status and control by the Unix socket of that name only, frames by that or its shared memory. By a name alone, a
    /// client that finds nobody looks for daemons of other names, and by the name "default" it takes whoever listens at
    /// the usual TCP port.
    bool by_unix_socket = false;

    /// Connects as disparity::connect() does, and throws as that. `role` tells this program's connections apart in the
    /// daemon's status.
    disparity::Client connect(const std::string& role, const disparity::Subscription& wanted) const;
};

/// Returns a subscription to no frames.
disparity::Subscription no_frames();

}  // namespace disparityd::web
