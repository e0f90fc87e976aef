// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "kernels/image.h"

namespace disparityd::scan {

/// Step 14 sorts pixels by their distance: the bins are a quarter of a pixel wide up to 8 px, and a 32nd of the value
/// beyond. A bin has the index min over k = 0 .. 6 of 32 k + floor(x / 2^k), where x is the disparity in quarters.
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

/// Rows that share their sectors' edges and weights.
inline constexpr int group_rows = 8;
/// A weight of 1.
inline constexpr int weight_one = 1 << 14;

/// The last row of a group, plus one.
constexpr int group_end(int group, int height) {
    return std::min((group + 1) * group_rows, height);
}

/// The row in the middle of a group, of the last group perhaps its last one.
constexpr int group_middle(int group, int height) {
    return std::min(group * group_rows + group_rows / 2, height - 1);
}

/// A disparity in sixteenths, brought to the horizontal distance by its pixel's weight.
constexpr int at_horizontal_distance(int sixteenths, std::uint16_t weight) {
    constexpr int most = 16383;
    return (2 * std::clamp(sixteenths, 0, most) * weight + weight_one) >> 15;
}

/// A finished disparity image and its confidence.
struct Pixels {
    Plane<const std::int16_t> disparity;
    Plane<const std::uint8_t> confidence;
};

/// Disparities in sixteenths at the horizontal distance: those from `seen` to `nearest` count as measured, those from
/// `obstacle` on as obstacles. The distance is sure enough from `sure` on; what is less is farther away, but nobody
/// knows how far.
struct Limits {
    int seen = 0;
    int sure = 0;
    int obstacle = 0;
    int nearest = 0;
};

/// What counting has to know of sectors and heights: views of memory that others own.
struct CountTables {
    int offset16 = 0;        ///< of DepthScale
    int min_confidence = 1;  ///< obstacle pixels with less say nothing; 1 .. 255
    Limits limits;
    /// By group and column: sixteenths of disparity to those at the horizontal distance, times weight_one.
    Plane<const std::uint16_t> weights;
    /// By group and column: the pixel's sector; as many as there are sectors where it has none.
    Plane<const std::uint16_t> sectors_of_columns;
    /// By group: sector s has the columns [edges[s + 1], edges[s]).
    Plane<const std::int16_t> edges;

    // The disparities, in sixteenths, that a pixel needs to lie within the band of heights: both limits are a number of
    // its column plus one of its row.
    const std::int16_t* low_of_columns = nullptr;
    const std::int16_t* high_of_columns = nullptr;
    const std::int16_t* low_of_rows = nullptr;
    const std::int16_t* high_of_rows = nullptr;
    /// A pixel is within the band when its disparity is at least the low limit, and more than the high one, or less
    /// than it where the camera is above the band.
    bool above = false;

    /// Whether pixel (x, y) with this disparity lies within the band.
    bool in_band(int x, int y, int sixteenths) const {
        const int low = low_of_columns[x] + low_of_rows[y];
        const int high = high_of_columns[x] + high_of_rows[y];
        const bool below_high = above ? sixteenths < high : sixteenths > high;
        return (static_cast<int>(sixteenths >= low) & static_cast<int>(below_high)) != 0;
    }
};

/// How many pixels of each sector lie in which bin of distance, how many of its pixels were measured per group of rows,
/// and the bins of the pixels in the middle row of each group.
struct Counts {
    Counts(int sector_count, int group_count, int image_width)
        : sectors(sector_count),
          groups(group_count),
          width(image_width),
          obstacle((static_cast<std::size_t>(sector_count) + 1) * bins),
          seen(static_cast<std::size_t>(sector_count) * static_cast<std::size_t>(group_count)),
          middle_bins(static_cast<std::size_t>(group_count) * static_cast<std::size_t>(image_width)),
          middle_counted(static_cast<std::size_t>(group_count)) {}

    std::uint32_t* obstacle_of(int sector) { return &obstacle[static_cast<std::size_t>(sector) * bins]; }
    const std::uint32_t* obstacle_of(int sector) const { return &obstacle[static_cast<std::size_t>(sector) * bins]; }
    std::uint32_t& seen_of(int sector, int group) {
        return seen[static_cast<std::size_t>(sector) * static_cast<std::size_t>(groups) +
                    static_cast<std::size_t>(group)];
    }
    std::uint32_t seen_of(int sector, int group) const {
        return seen[static_cast<std::size_t>(sector) * static_cast<std::size_t>(groups) +
                    static_cast<std::size_t>(group)];
    }

    /// The bins of row group_middle(group), one per column.
    std::uint8_t* middle_bins_of(int group) {
        return &middle_bins[static_cast<std::size_t>(group) * static_cast<std::size_t>(width)];
    }
    const std::uint8_t* middle_bins_of(int group) const {
        return &middle_bins[static_cast<std::size_t>(group) * static_cast<std::size_t>(width)];
    }

    int sectors;
    int groups;
    int width;
    /// By sector and bin. The last bin of each, and a sector more, hold what is counted nowhere else; their values are
    /// not defined.
    std::vector<std::uint32_t> obstacle;
    std::vector<std::uint32_t> seen;           ///< by sector and group
    std::vector<std::uint8_t> middle_bins;     ///< by group and column: no_bin where a pixel is not counted in a bin
    std::vector<std::uint8_t> middle_counted;  ///< by group: 1 where that row has a pixel in a bin, else 0
};

/// Step 14, the part that looks at every pixel: fills in all of `counts`. Image, tables and counts have one size. Pure;
/// no allocation.
using CountPixels = void(const Pixels& pixels, const CountTables& tables, Counts& counts);

}  // namespace disparityd::scan
