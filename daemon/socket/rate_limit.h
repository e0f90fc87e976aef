// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace disparityd::daemon {

/// Allows `burst` events at once, then one per interval. One thread at a time.
class RateLimit {
public:
    using Clock = std::chrono::steady_clock;

    RateLimit(int burst, Clock::duration interval) : interval_(interval), ahead_((burst - 1) * interval) {}

    /// Returns how long the next event has to wait; zero: not at all.
    Clock::duration wait(Clock::time_point now = Clock::now()) const {
        return std::max(Clock::duration::zero(), due_ - ahead_ - now);
    }

    /// Counts `count` events, now or after wait().
    void take(std::int64_t count = 1, Clock::time_point now = Clock::now()) {
        due_ = std::max(due_, now) + count * interval_;
    }

    /// Takes one event back that was counted before it was known that another limit applies to it.
    void give_back() { due_ -= interval_; }

private:
    const Clock::duration interval_;
    const Clock::duration ahead_;  ///< how long before its turn an event may come
    Clock::time_point due_{};      ///< turn of the next event at the steady rate
};

}  // namespace disparityd::daemon
