// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bridges/web/daemon/daemon_link.h"
#include "bridges/web/images/live_frame.h"

namespace disparityd::web {

/// Reads frames in a thread of its own: by the client library, from shared memory where it can. It reads nothing while
/// nobody wants anything, and never makes the daemon wait. A daemon may come and go.
class FrameFeed {
public:
    /// `on_frame` is called in the feed's thread, at most once until taken() is called: a frame that comes meanwhile
    /// takes the place of the one that waits.
    FrameFeed(DaemonAddress daemon, std::function<void()> on_frame);
    ~FrameFeed();
    FrameFeed(const FrameFeed&) = delete;
    FrameFeed& operator=(const FrameFeed&) = delete;

    /// Tells the thread to end, and does not wait for it; any thread.
    void stop();

    /// Says which products the next frames should have, of those that the daemon serves; any thread.
    void want(const std::set<disparity::Product>& products);

    /// Returns the newest frame, once; any thread.
    std::shared_ptr<const LiveFrame> take();

private:
    void run();
    bool serve(std::set<disparity::Product> wanted);
    std::set<disparity::Product> wants();
    std::set<disparity::Product> wait_for_wants();
    bool pause();
    void hand_over(disparity::Frame&& frame);

    const DaemonAddress daemon_;
    const std::function<void()> on_frame_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::set<disparity::Product> wanted_;
    std::shared_ptr<const LiveFrame> newest_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace disparityd::web
