// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// The equiangular fit: how far, in 1/16 px, the minimum lies from the middle one of three costs.
int offset16(int minus, int least, int plus) {
    const int steeper = std::max(minus, plus) - least;
    if (steeper == 0) {
        return 0;
    }
    const int magnitude = (16 * std::abs(minus - plus) + steeper) / (2 * steeper);
    return minus >= plus ? magnitude : -magnitude;
}

}  // namespace

template <typename T>
void winner_left(Volume<const T> costs, DisparityRange range, bool subpixel, Plane<std::int16_t> winner,
                 Plane<std::int16_t> disparity, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < costs.width; ++x) {
            const T* cost = costs.pixel(x, y);
            T least = cost[0];
            for (int k = 1; k < range.count; ++k) {
                least = std::min(least, cost[k]);
            }
            const int k = static_cast<int>(std::find(cost, cost + range.count, least) - cost);
            const bool at_end = k == 0 || k == range.count - 1;
            const int offset = subpixel && !at_end ? offset16(cost[k - 1], least, cost[k + 1]) : 0;
            winner.at(x, y) = static_cast<std::int16_t>(range.first + k);
            disparity.at(x, y) = static_cast<std::int16_t>(16 * (range.first + k) + offset);
        }
    }
}

template <typename T>
void winner_right(Volume<const T> costs, DisparityRange range, Plane<std::int16_t> winner, Rows rows) {
    const int width = costs.width;
    std::array<std::uint16_t, max_side> least;
    for (int y = rows.first; y < rows.last; ++y) {
        std::int16_t* __restrict best = winner.row(y);
        std::fill_n(best, width, static_cast<std::int16_t>(range.first - 1));
        std::fill_n(least.begin(), width, std::uint16_t{65535});  // no cost is as large
        for (int x = 0; x < width; ++x) {
            // Candidate k of left pixel x is one of right pixel x - range.first - k. The candidates of a
            // right pixel come in ascending order, so that the smallest of equal ones stays.
            const T* __restrict cost = costs.pixel(x, y);
            std::uint16_t* __restrict min_of = least.data();
            const int first = std::clamp(x - (width - 1) - range.first, 0, range.count);
            const int last = std::clamp(x + 1 - range.first, first, range.count);
            for (int k = first; k < last; ++k) {
                const int right_x = x - range.first - k;
                const bool better = cost[k] < min_of[right_x];
                best[right_x] = better ? static_cast<std::int16_t>(range.first + k) : best[right_x];
                min_of[right_x] = better ? cost[k] : min_of[right_x];
            }
        }
    }
}

template void winner_left<std::uint8_t>(Volume<const std::uint8_t>, DisparityRange, bool, Plane<std::int16_t>,
                                        Plane<std::int16_t>, Rows);
template void winner_left<std::uint16_t>(Volume<const std::uint16_t>, DisparityRange, bool, Plane<std::int16_t>,
                                         Plane<std::int16_t>, Rows);
template void winner_right<std::uint8_t>(Volume<const std::uint8_t>, DisparityRange, Plane<std::int16_t>, Rows);
template void winner_right<std::uint16_t>(Volume<const std::uint16_t>, DisparityRange, Plane<std::int16_t>, Rows);

}  // namespace disparityd::reference
