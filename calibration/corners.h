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

/// The strongest corner of each square of a grid over the image, row by row; none in a square without texture in both
/// directions, none nearer than `border` to the edge. Shi and Tomasi's measure: the smaller eigenvalue of the structure
/// tensor. Whole numbers: the same corners on every machine.
std::vector<Pixel> find_corners(Plane<const std::uint8_t> image, int square, int border);

}  // namespace disparityd::calibration
