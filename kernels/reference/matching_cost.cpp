// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr std::uint8_t outside = 62;

// std::popcount in plain operations: compilers turn a loop over this into vector code on any machine.
std::uint8_t popcount(std::uint64_t v) {
    v -= v >> 1 & 0x5555555555555555;
    v = (v & 0x3333333333333333) + (v >> 2 & 0x3333333333333333);
    v = (v + (v >> 4)) & 0x0f0f0f0f0f0f0f0f;
    v += v >> 8;
    v += v >> 16;
    v += v >> 32;
    return static_cast<std::uint8_t>(v & 0x7f);
}

}  // namespace

void matching_cost(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                   Volume<std::uint8_t> costs, Rows rows) {
    const int width = left.width;
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < width; ++x) {
            // The candidates first .. last - 1, counted from range.first, lie inside the right image.
            const int first = std::clamp(x - (width - 1) - range.first, 0, range.count);
            const int last = std::clamp(x + 1 - range.first, first, range.count);
            const std::uint64_t word = left.at(x, y);
            const std::uint64_t* __restrict candidates = right.row(y);
            std::uint8_t* __restrict cost = costs.pixel(x, y);
            std::fill_n(cost, range.count, outside);
            for (int k = first; k < last; ++k) {
                cost[k] = popcount(word ^ candidates[x - range.first - k]);
            }
        }
    }
}

}  // namespace disparityd::reference
