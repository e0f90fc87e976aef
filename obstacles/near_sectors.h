// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/image.h"
#include "kernels/scan_counts.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// What the near guard has found in a frame.
struct NearBlocks {
    Plane<const std::int16_t> disparities;  ///< FrameView::near; empty where the guard is off
    int at_least16 = 0;                     ///< what is near has at least this disparity, in 1/16 px
};

/// Tells sectors in which something is nearer than can be measured: step 14 of docs/algorithm.md, the part "Near".
/// Memory is allocated by the constructor only.
class NearSectors {
public:
    explicit NearSectors(const Geometry& geometry) : found_(index(geometry.sectors())) {}

    /// Makes the sectors occupied in which blocks are near, and doubtful where they may be. `tables` are those of the
    /// frame's geometry and `ground`; `sectors` has geometry.sectors() elements.
    void add(const NearBlocks& near, const Geometry& geometry, const CountTables& tables, const GroundPlane& ground,
             std::span<ScanSector> sectors);

    /// Returns how many blocks of the newest frame are near and show no ground.
    std::ptrdiff_t blocks() const { return blocks_; }

private:
    struct Found {
        int blocks = 0;      ///< in the band
        int not_ground = 0;  ///< these, and those above the band
        int m = 0;           ///< of the nearest one at the end of the range: 1/16 px at the horizontal distance
    };

    void find(const NearBlocks& near, const Geometry& geometry, const CountTables& tables, const GroundPlane& ground);

    std::vector<Found> found_;  ///< by sector
    std::ptrdiff_t blocks_ = 0;
};

}  // namespace disparityd::scan
