// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "bridges/web/daemon/daemon_link.h"
#include "bridges/web/daemon/hub.h"

namespace disparityd::web {

/// Asks the daemon for its status, in a thread of its own, and reads its sensors when somebody wants them. A daemon may
/// come and go.
class StatusFeed {
public:
    static constexpr std::chrono::milliseconds usual_interval{500};
    static constexpr auto never = std::chrono::milliseconds::max();

    /// Both functions are called in the feed's thread.
    StatusFeed(DaemonAddress daemon, std::function<void(DaemonState)> on_state,
               std::function<void(disparity::SensorBatch)> on_sensors);
    ~StatusFeed();
    StatusFeed(const StatusFeed&) = delete;
    StatusFeed& operator=(const StatusFeed&) = delete;

    /// Tells the thread to end, and does not wait for it; any thread.
    void stop();

    /// Says how often the status is asked for, at once where that is due; `never`: the daemon is left alone. Any
    /// thread.
    void set_interval(std::chrono::milliseconds interval);

    /// Any thread may say whether the sensors are wanted.
    void want_sensors(bool wanted);

private:
    void run();
    void serve();
    bool wait_until_due(std::chrono::steady_clock::time_point asked);
    bool rest(std::chrono::steady_clock::time_point begin, bool sensors);
    bool wants_sensors();
    std::chrono::milliseconds interval();

    const DaemonAddress daemon_;
    const std::function<void(DaemonState)> on_state_;
    const std::function<void(disparity::SensorBatch)> on_sensors_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::chrono::milliseconds interval_ = usual_interval;
    bool sensors_ = false;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace disparityd::web
