// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/system/system_error.hpp>

#include "base/start_thread.h"
#include "daemon/ends_alone.h"

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

/// Posts a piece of work to the thread; it ends_alone().
template <typename Executor, typename Work>
void do_in(Executor& thread, const char* what, Work work) {
    boost::asio::post(thread, [what, work = std::move(work)]() mutable { ends_alone(what, work); });
}

}  // namespace disparityd::daemon
