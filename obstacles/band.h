// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/scan_counts.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// The disparities, in sixteenths, that a pixel needs to lie within the band of heights: both limits change linearly
/// over the image, so each is a number of its column plus one of its row.
class Band {
public:
    Band(int width, int height);

    /// Computes the limits above a plane of the ground.
    void set(const Geometry& geometry, const GroundPlane& ground);

private:
    friend CountTables count_tables(const Geometry& geometry, const Band& band);

    std::vector<std::int16_t> low_x_, low_y_, high_x_, high_y_;
    bool above_ = false;
};

/// Returns what the counting kernel reads: views of the memory of both, valid until one of them is set again.
CountTables count_tables(const Geometry& geometry, const Band& band);

}  // namespace disparityd::scan
