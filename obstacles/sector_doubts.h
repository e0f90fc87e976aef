// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/image.h"
#include "kernels/scan_counts.h"
#include "kernels/stage_notes.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// What a frame has beside its disparities.
struct Sight {
    Plane<const std::uint8_t> left;  ///< the rectified left image; empty where it is not known
    StageNotes* notes = nullptr;     ///< null: there is no other stage
};

/// Tells how far each sector can be trusted, and why not: step 14 of docs/algorithm.md, the part "Doubts". Memory is
/// allocated by the constructor only.
class SectorDoubts {
public:
    explicit SectorDoubts(const Geometry& geometry) : found_(index(geometry.sectors())) {}

    /// Fills in doubts and trust. A doubt that a sector has already stays. `sectors` has geometry.sectors() elements.
    void add(const Pixels& pixels, const Sight& sight, const Geometry& geometry, std::span<ScanSector> sectors);

private:
    /// Pixels that are looked at.
    struct Found {
        int all = 0;
        int measured = 0;
        int dark = 0;
        int white = 0;
        int dirty = 0;
    };

    void look(const Pixels& pixels, const Sight& sight, const Geometry& geometry);
    void look_for_dirt(const PixelBox& box, const Geometry& geometry);

    std::vector<Found> found_;  ///< by sector
};

}  // namespace disparityd::scan
