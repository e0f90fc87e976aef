// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/corners.h"

#include <algorithm>
#include <cmath>

namespace disparityd::calibration {

namespace {

constexpr int radius = 3;  // of the window that the structure tensor is summed over

// A smaller grey step in two directions does not stand out of a camera's noise.
constexpr std::int64_t least_step = 5;
constexpr std::int64_t least_eigenvalue = least_step * least_step * (2 * radius + 1) * 2;

/// Returns the smaller eigenvalue of the structure tensor around a pixel, rounded down.
std::int64_t corner_strength(Plane<const std::uint8_t> image, Pixel at) {
    std::int64_t xx = 0;
    std::int64_t xy = 0;
    std::int64_t yy = 0;
    for (int y = at.y - radius; y <= at.y + radius; ++y) {
        const std::uint8_t* row = image.row(y);
        const std::uint8_t* above = image.row(y - 1);
        const std::uint8_t* below = image.row(y + 1);
        for (int x = at.x - radius; x <= at.x + radius; ++x) {
            const int dx = row[x + 1] - row[x - 1];
            const int dy = below[x] - above[x];
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
    }
    const std::int64_t difference = xx - yy;
    const auto root = std::sqrt(static_cast<double>(difference * difference + 4 * xy * xy));
    return (xx + yy - static_cast<std::int64_t>(std::ceil(root))) / 2;
}

}  // namespace

std::vector<Pixel> find_corners(Plane<const std::uint8_t> image, int square, int border) {
    const int edge = std::max(border, radius + 1);
    std::vector<Pixel> corners;
    for (int top = edge; top < image.height - edge; top += square) {
        for (int first = edge; first < image.width - edge; first += square) {
            Pixel best;
            std::int64_t strongest = least_eigenvalue;
            for (int y = top; y < std::min(top + square, image.height - edge); ++y) {
                for (int x = first; x < std::min(first + square, image.width - edge); ++x) {
                    const std::int64_t strength = corner_strength(image, {x, y});
                    if (strength > strongest) {
                        strongest = strength;
                        best = {x, y};
                    }
                }
            }
            if (strongest > least_eigenvalue) {
                corners.push_back(best);
            }
        }
    }
    return corners;
}

}  // namespace disparityd::calibration
