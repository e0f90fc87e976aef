// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/latency_window.h"

#include <algorithm>

namespace disparityd::tools {
namespace {

/// Returns the smallest value that at least `percent` of all values do not exceed.
double percentile_ms(const std::vector<std::int64_t>& sorted_ns, std::size_t percent) {
    if (sorted_ns.empty()) {
        return 0;
    }
    const std::size_t rank = (sorted_ns.size() * percent + 99) / 100;
    return static_cast<double>(sorted_ns[std::max<std::size_t>(rank, 1) - 1]) / 1e6;
}

}  // namespace

void LatencyWindow::add(const disparity::Frame& frame) {
    ages_ns_.push_back(frame.age_ns);
    dropped_ += frame.dropped_before;
    skipped_ += frame.skipped;
}

LatencyWindow::Summary LatencyWindow::take() {
    std::sort(ages_ns_.begin(), ages_ns_.end());
    const Summary summary{ages_ns_.size(), percentile_ms(ages_ns_, 50), percentile_ms(ages_ns_, 99), dropped_,
                          skipped_};
    ages_ns_.clear();
    dropped_ = 0;
    skipped_ = 0;
    return summary;
}

}  // namespace disparityd::tools
