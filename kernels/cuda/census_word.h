// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cuda/launch.h"

namespace disparityd::cuda {

constexpr int census_radius_x = 4;
constexpr int census_radius_y = 3;

/// Step 3 for one pixel; read(dx, dy) gives the pixel that lies so far from it.
template <typename Read>
__device__ std::uint64_t census_word(Read read) {
    const std::uint8_t centre = read(0, 0);
    std::uint64_t word = 0;
#pragma unroll
    for (int dy = -census_radius_y; dy <= census_radius_y; ++dy) {
#pragma unroll
        for (int dx = -census_radius_x; dx <= census_radius_x; ++dx) {
            if (dy != 0 || dx != 0) {
                word = word << 1 | (read(dx, dy) < centre ? 1U : 0U);
            }
        }
    }
    return word;
}

constexpr int gradient_census_radius_x = 3;
constexpr int gradient_census_radius_y = 2;

/// The census part of step 3 with census-7x5+gradient for one pixel; read as in census_word(). A bit is set where a
/// pixel is below `limit`; rows are `row_step` apart.
template <int row_step, typename Read>
__device__ std::uint32_t gradient_census_bits(Read read, int limit) {
    std::uint32_t bits = 0;
#pragma unroll
    for (int dy = -gradient_census_radius_y; dy <= gradient_census_radius_y; ++dy) {
#pragma unroll
        for (int dx = -gradient_census_radius_x; dx <= gradient_census_radius_x; ++dx) {
            const bool corner = dx * dx == gradient_census_radius_x * gradient_census_radius_x &&
                                dy * dy == gradient_census_radius_y * gradient_census_radius_y;
            if ((dy != 0 || dx != 0) && !corner) {
                bits = bits << 1 | (read(dx, row_step * dy) < limit ? 1U : 0U);
            }
        }
    }
    return bits;
}

/// The gradient byte.
template <int shift, typename Read>
__device__ std::uint8_t gradient_byte(Read read) {
    constexpr int most = 16 << shift;
    int sobel = 0;
#pragma unroll
    for (int dy = -1; dy <= 1; ++dy) {
        sobel += (dy == 0 ? 2 : 1) * (int{read(1, dy)} - int{read(-1, dy)});
    }
    // An arithmetic shift rounds down.
    return static_cast<std::uint8_t>(128 + (clamp(sobel, -most, most) >> shift));
}

}  // namespace disparityd::cuda
