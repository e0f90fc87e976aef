// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/image.h"

namespace disparityd::calibration {

struct Pixel {
    int x = 0;
    int y = 0;
};

/// Finds the strongest corner of each square of a grid over the image, row by row. A square without texture in both
/// directions has none; none lies nearer than `border` pixels to the edge. The measure is Shi and Tomasi's, the smaller
/// eigenvalue of the structure tensor, in integers: it gives the same corners on every machine.
std::vector<Pixel> find_corners(Plane<const std::uint8_t> image, int square, int border);

}  // namespace disparityd::calibration
