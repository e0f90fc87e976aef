// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace disparityd::daemon {

/// Counts how much of the compressor one client has used. One thread.
class CompressorAccount {
public:
    using Clock = std::chrono::steady_clock;

    /// Adds `bytes` of input and `time` of the compressor's thread, which ended at `now`.
    void charge(std::uint64_t bytes, std::chrono::nanoseconds time, Clock::time_point now) {
        bytes_ += bytes;
        time_ += time;
        roll(now);
        current_ += time;
    }

    std::uint64_t bytes() const { return bytes_; }
    std::chrono::nanoseconds time() const { return time_; }

    /// Returns the client's share of the compressor's time in the last one to two seconds, 0 .. 1.
    double share(Clock::time_point now) {
        roll(now);
        const std::chrono::duration<double> had = before_ + current_;
        const double share = had / (interval + (now - since_));
        return share < 1 ? share : 1;
    }

private:
    static constexpr Clock::duration interval = std::chrono::seconds(1);

    void roll(Clock::time_point now) {
        if (now - since_ < interval) {
            return;
        }
        before_ = now - since_ < 2 * interval ? current_ : std::chrono::nanoseconds(0);
        current_ = {};
        since_ = now - since_ < 2 * interval ? since_ + interval : now;
    }

    std::uint64_t bytes_ = 0;
    std::chrono::nanoseconds time_{0};
    Clock::time_point since_ = Clock::now();  ///< start of the second that current_ counts
    std::chrono::nanoseconds current_{0};
    std::chrono::nanoseconds before_{0};  ///< in the previous second
};

}  // namespace disparityd::daemon
