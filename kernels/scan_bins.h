// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

/// Step 14 sorts pixels by their distance: the bins are a quarter of a pixel wide up to 8 px, and a 32nd of the value
/// beyond. A bin has the index min over k = 0 .. 6 of 32 k + floor(x / 2^k), where x is the disparity in quarters.
namespace disparityd::scan {

inline constexpr int bins = 256;
/// Counts nothing: not measured, ground or overhead.
inline constexpr std::uint8_t no_bin = 255;
inline constexpr int largest_quarters = 2047;
inline constexpr int max_shift = 6;
inline constexpr int used_bins = 32 * max_shift + (largest_quarters >> max_shift) + 1;
static_assert(used_bins <= no_bin);

/// The bin of a disparity in sixteenths that has been brought to the horizontal distance.
constexpr std::uint8_t bin_of(int sixteenths) {
    const int quarters = std::clamp(sixteenths >> 2, 0, largest_quarters);
    int bin = quarters;
    for (int k = 1; k <= max_shift; ++k) {
        bin = std::min(bin, 32 * k + (quarters >> k));
    }
    return static_cast<std::uint8_t>(bin);
}

/// The least disparity of a bin, in sixteenths. Of used_bins: the end of the last one.
constexpr int bin_begin(int bin) {
    const int k = bin < 64 ? 0 : bin / 32 - 1;
    return ((bin - 32 * k) << k) * 4;
}

static_assert(bin_of(0) == 0 && bin_of(4 * largest_quarters) == used_bins - 1);
static_assert(bin_begin(63) == 252 && bin_of(252) == 63 && bin_begin(64) == 256 && bin_of(256) == 64 &&
              bin_of(bin_begin(200)) == 200 && bin_of(bin_begin(200) - 1) == 199);

}  // namespace disparityd::scan
