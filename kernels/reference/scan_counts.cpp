// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

void scan_counts(const scan::Pixels& pixels, const scan::Geometry& geometry, const scan::Band& band,
                 scan::Counts& counts) {
    std::fill(counts.obstacle.begin(), counts.obstacle.end(), 0);
    std::fill(counts.seen.begin(), counts.seen.end(), 0);
    const auto& limits = geometry.limits();
    const int offset = std::clamp(geometry.camera().scale.offset16, -32768, 32767);
    for (int group = 0; group < counts.groups; ++group) {
        const std::int16_t* edges = geometry.edges(group);
        for (int s = 0; s < counts.sectors; ++s) {
            for (int y = group * scan::group_rows; y < geometry.group_end(group); ++y) {
                for (int x = edges[s + 1]; x < edges[s]; ++x) {
                    const int n = std::clamp(pixels.disparity.at(x, y) + offset, -32768, 32767);
                    const int rounded = scan::at_horizontal_distance(n, geometry.weights(group)[x]);
                    const int confidence = pixels.confidence.at(x, y);
                    if (confidence == 0 || rounded < limits.seen || rounded > limits.nearest) {
                        continue;
                    }
                    const bool obstacle = rounded >= limits.obstacle && band.contains(x, y, n);
                    const bool sure = confidence >= geometry.options().min_confidence;
                    if (!obstacle || sure) {
                        ++counts.seen_of(s, group);
                    }
                    if (obstacle && sure) {
                        ++counts.obstacle_of(s)[scan::bin_of(rounded)];
                    }
                }
            }
        }
    }
}

}  // namespace disparityd::reference
