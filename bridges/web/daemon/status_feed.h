// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "bridges/web/daemon/daemon_link.h"
#include "bridges/web/daemon/hub.h"

namespace disparityd::web {

/// Asks the daemon for its status twice a second, in a thread of its own, and reads its sensors when somebody wants
/// them. A daemon may come and go.
class StatusFeed {
public:
    /// Both functions are called in the feed's thread.
    StatusFeed(DaemonAddress daemon, std::function<void(DaemonState)> on_state,
               std::function<void(disparity::SensorBatch)> on_sensors);
    ~StatusFeed();
    StatusFeed(const StatusFeed&) = delete;
    StatusFeed& operator=(const StatusFeed&) = delete;

    /// Tells the thread to end, and does not wait for it; any thread.
    void stop();

    /// Any thread may say whether the sensors are wanted.
    void want_sensors(bool wanted);

private:
    void run();
    void serve();
    bool wait(std::chrono::milliseconds time);
    bool wants_sensors();

    const DaemonAddress daemon_;
    const std::function<void(DaemonState)> on_state_;
    const std::function<void(disparity::SensorBatch)> on_sensors_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool sensors_ = false;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace disparityd::web
