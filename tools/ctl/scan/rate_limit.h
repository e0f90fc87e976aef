// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

namespace disparityd::tools {

/// Lets at most `rate` events a second through; all of them without a rate.
class RateLimit {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit RateLimit(std::optional<double> rate)
        : interval_(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(rate ? 1 / *rate : 0))) {}

    bool allows(Time now) {
        if (now < next_) {
            return false;
        }
        // On a grid, so that events that come a little late do not lower the rate; a new one after a pause.
        const bool late = now - next_ > interval_;
        next_ = (late ? now : next_) + interval_;
        return true;
    }

private:
    Time::duration interval_;
    Time next_;
};

}  // namespace disparityd::tools
