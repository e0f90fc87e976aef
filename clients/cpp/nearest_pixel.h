// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace disparity {

/// Returns the index of the nearest pixel among those of `step` columns and rows from (column, row) on that lie inside
/// of the image; of several the first, row by row; (column, row) where no depth is known. So nothing thin is lost where
/// an image is thinned out. `depth_at` returns the depth of a pixel by its index: infinity or NaN count as unknown.
template <typename Depth>
std::size_t nearest_pixel(std::uint32_t width, std::uint32_t height, std::uint32_t column, std::uint32_t row,
                          std::uint32_t step, Depth depth_at) {
    std::size_t nearest = std::size_t{row} * width + column;
    float least = depth_at(nearest);
    for (std::uint32_t y = row; y < std::min(row + step, height); ++y) {
        for (std::uint32_t x = column; x < std::min(column + step, width); ++x) {
            const std::size_t pixel = std::size_t{y} * width + x;
            const float depth = depth_at(pixel);
            if (std::isfinite(depth) && !(least <= depth)) {
                nearest = pixel;
                least = depth;
            }
        }
    }
    return nearest;
}

/// Calls `take` with the nearest_pixel() of each block of `step` columns and rows, row of blocks by row of blocks.
template <typename Depth, typename Take>
void for_each_nearest(std::uint32_t width, std::uint32_t height, std::uint32_t step, Depth depth_at, Take take) {
    for (std::uint32_t row = 0; row < height; row += step) {
        for (std::uint32_t column = 0; column < width; column += step) {
            take(nearest_pixel(width, height, column, row, step, depth_at));
        }
    }
}

}  // namespace disparity
