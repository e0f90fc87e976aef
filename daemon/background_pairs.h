// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "kernels/image.h"
#include "kernels/matcher.h"

namespace disparityd::daemon {

/// Looks at rectified pairs in a thread of its own, at the lowest priority. The publish thread copies a pair only while
/// that thread waits for one; no other thread waits for it.
class BackgroundPairs {
public:
    /// Is called in the thread with each pair. What it throws is logged.
    using Look = std::function<void(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right)>;

    /// `name`: of the thread, at most 15 characters. `interval`: between the end of a look and the next pair.
    BackgroundPairs(const char* name, int width, int height, std::chrono::nanoseconds interval, Look look);
    /// Waits for a look under way, which stopping() ends early.
    ~BackgroundPairs();
    BackgroundPairs(const BackgroundPairs&) = delete;
    BackgroundPairs& operator=(const BackgroundPairs&) = delete;

    /// Returns whether a pair is wanted. Any thread. From then on until the publish thread calls give() the thread
    /// waits: what belongs to the pair may be left for the look.
    bool wants() const noexcept {
        return stage_.load(std::memory_order_acquire) == wanted &&
               std::chrono::steady_clock::now() >= due_.load(std::memory_order_relaxed);
    }

    /// Copies the pair, after wants(). Publish thread. Allocates nothing.
    void give(const FrameView& frame) noexcept;

    /// Is true when a look should end early.
    const std::atomic<bool>& stopping() const { return stopping_; }

private:
    enum Stage : int { busy, wanted, filled };

    void run();

    const char* const name_;
    const int width_;
    const int height_;
    const std::chrono::nanoseconds interval_;
    const Look look_;
    std::atomic<int> stage_{busy};
    std::atomic<bool> stopping_{false};
    std::atomic<std::chrono::steady_clock::time_point> due_{std::chrono::steady_clock::time_point()};
    // The publish thread owns these while the stage is `wanted`, else the other one.
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::thread thread_;
};

}  // namespace disparityd::daemon
