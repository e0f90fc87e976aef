// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scan_counts.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// Tells sectors in which the ground ends: at steps down, holes and edges. Step 14 of docs/algorithm.md, the part
/// "Drops". Memory is allocated by the constructor only.
class DropSectors {
public:
    explicit DropSectors(const Geometry& geometry);

    /// Makes the sectors occupied in which a drop comes before any obstacle. `tables` are those of the frame's geometry
    /// and ground; `sectors` has geometry.sectors() elements.
    void add(const Pixels& pixels, const Geometry& geometry, const CountTables& tables, const GroundPlane& ground,
             std::span<ScanSector> sectors);

private:
    /// The pixels of a bin that show something below the ground.
    struct Bin {
        int pixels = 0;
        int confidence = 0;  ///< their sum
        float lowest_mm = 0;
    };

    void find(const Pixels& pixels, const Geometry& geometry, const CountTables& tables, const GroundPlane& ground);
    void describe(const Geometry& geometry, int sector, ScanSector& out) const;

    std::vector<Bin> bins_;     ///< by sector and bin of the distance at which the ground ends
    std::vector<int> columns_;  ///< that are looked at of each sector, the most over the groups
};

}  // namespace disparityd::scan
