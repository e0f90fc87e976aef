// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/reference/steps.h"

namespace disparityd::reference {
namespace {

/// What step 14 knows of a pixel.
struct Judged {
    bool seen = false;
    std::uint8_t bin = scan::no_bin;  ///< of an obstacle's pixel
};

Judged judge(const scan::Pixels& pixels, const scan::Geometry& geometry, const scan::Band& band, int x, int y) {
    const auto& limits = geometry.limits();
    const int offset = std::clamp(geometry.camera().scale.offset16, -32768, 32767);
    const int n = std::clamp(pixels.disparity.at(x, y) + offset, -32768, 32767);
    const int rounded = scan::at_horizontal_distance(n, geometry.weights(y / scan::group_rows)[x]);
    const int confidence = pixels.confidence.at(x, y);
    if (confidence == 0 || rounded < limits.seen || rounded > limits.nearest) {
        return {};
    }
    if (rounded < limits.obstacle || !band.contains(x, y, n)) {
        return {.seen = true};
    }
    if (confidence < geometry.options().min_confidence) {
        return {};
    }
    return {.seen = true, .bin = scan::bin_of(rounded)};
}

}  // namespace

void scan_counts(const scan::Pixels& pixels, const scan::Geometry& geometry, const scan::Band& band,
                 scan::Counts& counts) {
    std::fill(counts.obstacle.begin(), counts.obstacle.end(), 0);
    std::fill(counts.seen.begin(), counts.seen.end(), 0);
    for (int group = 0; group < counts.groups; ++group) {
        const std::int16_t* edges = geometry.edges(group);
        for (int s = 0; s < counts.sectors; ++s) {
            for (int y = group * scan::group_rows; y < geometry.group_end(group); ++y) {
                for (int x = edges[s + 1]; x < edges[s]; ++x) {
                    const Judged pixel = judge(pixels, geometry, band, x, y);
                    counts.seen_of(s, group) += pixel.seen ? 1 : 0;
                    counts.obstacle_of(s)[pixel.bin] += pixel.bin != scan::no_bin ? 1 : 0;
                }
            }
        }
        bool counted = false;
        for (int x = 0; x < counts.width; ++x) {
            const std::uint8_t bin = judge(pixels, geometry, band, x, geometry.group_middle(group)).bin;
            counts.middle_bins_of(group)[x] = bin;
            counted = counted || bin != scan::no_bin;
        }
        counts.middle_counted[static_cast<std::size_t>(group)] = counted ? 1 : 0;
    }
}

}  // namespace disparityd::reference
