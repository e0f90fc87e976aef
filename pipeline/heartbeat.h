// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace disparityd::pipeline {

/// The sign of life of a stage thread. The thread beats each time it comes round its loop; any thread may ask for the
/// age.
class Heartbeat {
public:
    void beat() { last_ns_.store(now_ns(), std::memory_order_relaxed); }
    /// The time since the last beat.
    std::chrono::nanoseconds age() const {
        return std::chrono::nanoseconds(now_ns() - last_ns_.load(std::memory_order_relaxed));
    }

private:
    static std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
    std::atomic<std::int64_t> last_ns_{now_ns()};
};

/// The longest sleep of a stage thread between two beats.
inline constexpr std::chrono::milliseconds heartbeat_interval{100};

}  // namespace disparityd::pipeline
