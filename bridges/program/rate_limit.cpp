// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/rate_limit.h"

#include <algorithm>

namespace disparityd::bridges {

RateLimit::RateLimit(double per_second)
    : period_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / per_second))) {}

bool RateLimit::pass(Clock::time_point now) {
    const Clock::duration early = period_ / 4;
    if (now < due_ - early) {
        return false;
    }
    due_ = std::max(due_ + period_, now + period_ - early);
    return true;
}

}  // namespace disparityd::bridges
