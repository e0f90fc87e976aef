// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::bridges {

/// Returns the options of a client that may be there before the daemon. One that does not answer within a second hangs.
inline disparity::ClientOptions waiting_for_the_daemon(disparity::ClientOptions options) {
    options.may_be_absent = true;
    options.timeout = std::chrono::milliseconds(1000);
    return options;
}

}  // namespace disparityd::bridges
