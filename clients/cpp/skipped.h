// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparity {

/// Counts the published frames that a client did not read.
class SkippedCounter {
public:
    /// Returns how many frames were published between the one read before and this one; 0 for the first one, and after
    /// a restart of the daemon.
    std::uint64_t seen(std::uint64_t publish_index) {
        const std::uint64_t skipped = any_ && publish_index > last_ ? publish_index - last_ - 1 : 0;
        any_ = true;
        last_ = publish_index;
        return skipped;
    }

private:
    bool any_ = false;
    std::uint64_t last_ = 0;
};

}  // namespace disparity
