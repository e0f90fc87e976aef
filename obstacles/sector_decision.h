// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scan_counts.h"
#include "obstacles/image_mask.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// Decides what each sector shows, from the counts of its pixels: step 14, the part per sector. Memory is allocated by
/// the constructor only.
class SectorDecision {
public:
    explicit SectorDecision(const Geometry& geometry);

    /// Computes what follows from the geometry and the mask alone; to be called after Geometry::set().
    void set(const Geometry& geometry, const ImageMask& mask);

    /// Fills in all sectors. `sectors` has geometry.sectors() elements.
    void decide(const Pixels& pixels, const Geometry& geometry, const GroundPlane& ground, const Counts& counts,
                std::span<ScanSector> sectors);

private:
    /// The bins in which an obstacle was found: [first, last], last < 0: none.
    struct Found {
        int first = 0;
        int last = -1;
    };

    void set_area(const Geometry& geometry, const ImageMask& mask);
    void sum_windows(const Counts& counts);
    int nearest(const std::uint32_t* one, const std::uint32_t* other, int top, int columns, std::uint32_t all) const;
    void find_obstacles(const Geometry& geometry);
    double free_distance(const Geometry& geometry, const GroundPlane& ground, const Counts& counts, int sector) const;
    void describe(const Geometry& geometry, const Counts& counts, int sector, ScanSector& out) const;
    void add_extent(const Pixels& pixels, const Geometry& geometry, const GroundPlane& ground, const Counts& counts,
                    int sector, ScanSector& out) const;

    std::vector<std::uint32_t> windows_;      ///< by sector and bin: the pixels in it and the three before it
    std::vector<std::uint32_t> all_;          ///< by sector: its obstacle pixels
    std::vector<int> tops_;                   ///< by sector: the nearest bin with pixels in its window; -1: none
    std::vector<std::uint32_t> object_side_;  ///< by bin: the side of the smallest obstacle, 1/16 px
    std::vector<int> columns_;                ///< of each sector, the least over the groups that show it
    std::vector<double> resolved_;            ///< by sector: the smallest obstacle has pixels enough up to here, mm
    std::vector<std::uint32_t> area_;         ///< by sector and group, px
    std::vector<std::uint32_t> masked_;       ///< of that, px
    std::vector<bool> all_masked_;            ///< by sector: it has pixels, and all are masked
    std::vector<Found> found_;
};

}  // namespace disparityd::scan
