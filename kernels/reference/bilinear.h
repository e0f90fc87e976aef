// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::reference {

/// Calls sample(x, y, weight) for the four source pixels of entry (x, y) of a rectification map that lie inside the
/// source; the others count as 0 (docs/algorithm.md, step 1). The weights of all four add up to 1024.
template <typename Map, typename Sample>
void bilinear(const Map& map, int x, int y, int source_width, int source_height, Sample sample) {
    const int source_x = map.xy.at(2 * x, y);
    const int source_y = map.xy.at(2 * x + 1, y);
    const int fx = map.fraction.at(x, y) & 31;
    const int fy = (map.fraction.at(x, y) >> 5) & 31;
    for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
            const int px = source_x + dx;
            const int py = source_y + dy;
            if (px >= 0 && px < source_width && py >= 0 && py < source_height) {
                sample(px, py, (dx == 1 ? fx : 32 - fx) * (dy == 1 ? fy : 32 - fy));
            }
        }
    }
}

constexpr std::uint8_t round_bilinear(int weighted_sum) {
    return static_cast<std::uint8_t>((weighted_sum + 512) >> 10);
}

}  // namespace disparityd::reference
