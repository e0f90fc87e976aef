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

}  // namespace disparityd::cuda
