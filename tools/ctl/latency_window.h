// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::tools {

/// Collects the latencies and losses of the frames of one interval.
class LatencyWindow {
public:
    void add(const disparity::Frame& frame);

    struct Summary {
        std::uint64_t frames = 0;
        double p50_ms = 0;  ///< 0 when there were no frames
        double p99_ms = 0;
        std::uint64_t dropped = 0;  ///< lost before the daemon published
        std::uint64_t skipped = 0;  ///< published, but not read here
    };
    /// Returns the summary of all frames added since the call before.
    Summary take();

private:
    std::vector<std::int64_t> ages_ns_;
    std::uint64_t dropped_ = 0;
    std::uint64_t skipped_ = 0;
};

}  // namespace disparityd::tools
