// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd::bridges {

/// Lets at most so many through in a second, on the average; what comes a little early is let through, so that a source
/// of just that rate loses none.
class RateLimit {
public:
    using Clock = std::chrono::steady_clock;

    explicit RateLimit(double per_second);

    /// Returns whether one may pass now, and counts it if it may.
    bool pass(Clock::time_point now);

    Clock::duration period() const { return period_; }

private:
    Clock::duration period_;
    Clock::time_point due_{};
};

}  // namespace disparityd::bridges
