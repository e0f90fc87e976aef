// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros2 {

/// Reads what comes beside the frames, in a thread of its own: the daemon's status once a second, and samples of the
/// sensors while somebody wants them. A daemon may be away, come and go.
class SideFeed {
public:
    /// Called in the feed's thread. Exceptions of theirs count as the daemon's.
    struct Takers {
        std::function<void(const std::string& status)> status;             ///< a serialized disparityd.v1.Status
        std::function<void(const disparity::SensorBatch& batch)> samples;  ///< in order
        std::function<void(const std::string& why)> away;                  ///< one line: there is no status, and why
    };

    /// `where` as disparity::connect() takes it. Throws std::invalid_argument for another form.
    SideFeed(std::string where, disparity::ClientOptions options, Takers takers);
    ~SideFeed();
    SideFeed(const SideFeed&) = delete;
    SideFeed& operator=(const SideFeed&) = delete;

    /// Says whether samples are wanted; any thread.
    void want_samples(bool wanted);

private:
    void run();
    void serve();
    bool wait(std::chrono::milliseconds time);
    bool wants_samples();

    const std::string where_;
    const disparity::ClientOptions options_;
    const Takers takers_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool samples_ = false;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace disparityd::ros2
