// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparity {

/// Counts what a client did not see of the frames that the daemon published.
class MissedCounter {
public:
    /// Frames published between the one seen before and this one; 0 for the first, and after a restart of the daemon.
    std::uint64_t seen(std::uint64_t publish_index) {
        const std::uint64_t missed = any_ && publish_index > last_ ? publish_index - last_ - 1 : 0;
        any_ = true;
        last_ = publish_index;
        return missed;
    }

private:
    bool any_ = false;
    std::uint64_t last_ = 0;
};

}  // namespace disparity
