// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/image.h"
#include "kernels/scan/band.h"
#include "kernels/scan/scan_bins.h"
#include "kernels/scan/scan_geometry.h"

namespace disparityd::scan {

/// A finished disparity image and its confidence.
struct Pixels {
    Plane<const std::int16_t> disparity;
    Plane<const std::uint8_t> confidence;
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

    /// The bins of row Geometry::group_middle(group), one per column.
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

/// Step 14, the part that looks at every pixel: fills in all of `counts`. Image, geometry, band and counts have one
/// size. Pure; no allocation.
using CountPixels = void(const Pixels& pixels, const Geometry& geometry, const Band& band, Counts& counts);

}  // namespace disparityd::scan
