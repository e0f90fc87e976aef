// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/thread_pool.hpp>
#include <boost/system/system_error.hpp>

#include "base/signals_blocked.h"
#include "base/start_thread.h"

namespace disparityd::daemon {

/// Makes a thread for slow work, one piece after the other. Throws as base::start_thread() does.
inline boost::asio::thread_pool one_thread() {
    const base::SignalsBlocked inherited;
    try {
        return boost::asio::thread_pool(1);
    } catch (const boost::system::system_error& error) {
        base::refuse_thread(error.code().message());
    }
}

}  // namespace disparityd::daemon
