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

Judged judge(const scan::Pixels& pixels, const scan::CountTables& tables, int x, int y) {
    const scan::Limits& limits = tables.limits;
    const int offset = std::clamp(tables.offset16, -32768, 32767);
    const int n = std::clamp(pixels.disparity.at(x, y) + offset, -32768, 32767);
    const int rounded = scan::at_horizontal_distance(n, tables.weights.at(x, y / scan::group_rows));
    const int confidence = pixels.confidence.at(x, y);
    if (confidence == 0 || rounded < limits.seen || rounded > limits.nearest) {
        return {};
    }
    if (rounded < limits.obstacle || !tables.in_band(x, y, n)) {
        return {.seen = true};
    }
    if (confidence < tables.min_confidence) {
        return {};
    }
    return {.seen = true, .bin = scan::bin_of(rounded)};
}

}  // namespace

void scan_counts(const scan::Pixels& pixels, const scan::CountTables& tables, scan::Counts& counts) {
    const int height = pixels.disparity.height;
    std::fill(counts.obstacle.begin(), counts.obstacle.end(), 0);
    std::fill(counts.seen.begin(), counts.seen.end(), 0);
    for (int group = 0; group < counts.groups; ++group) {
        const std::int16_t* edges = tables.edges.row(group);
        for (int s = 0; s < counts.sectors; ++s) {
            for (int y = group * scan::group_rows; y < scan::group_end(group, height); ++y) {
                for (int x = edges[s + 1]; x < edges[s]; ++x) {
                    const Judged pixel = judge(pixels, tables, x, y);
                    counts.seen_of(s, group) += pixel.seen ? 1 : 0;
                    counts.obstacle_of(s)[pixel.bin] += pixel.bin != scan::no_bin ? 1 : 0;
                }
            }
        }
        bool counted = false;
        for (int x = 0; x < counts.width; ++x) {
            const std::uint8_t bin = judge(pixels, tables, x, scan::group_middle(group, height)).bin;
            counts.middle_bins_of(group)[x] = bin;
            counted = counted || bin != scan::no_bin;
        }
        counts.middle_counted[static_cast<std::size_t>(group)] = counted ? 1 : 0;
    }
}

}  // namespace disparityd::reference
