// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/thread_pool.hpp>
#include <boost/system/system_error.hpp>

#include "capture/start_thread.h"

namespace disparityd {

/// A thread for work that may take its time, one piece after the other. Throws as capture::start_thread does.
inline boost::asio::thread_pool one_thread() {
    try {
        return boost::asio::thread_pool(1);
    } catch (const boost::system::system_error& error) {
        capture::refuse_thread(error.code().message());
    }
}

}  // namespace disparityd
