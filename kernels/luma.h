// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/raw_image.h"

namespace disparityd {

/// Returns the luma of pixel x of a captured row, 0 .. 255, as step 1 of docs/algorithm.md has it.
template <PixelFormat format>
constexpr int luma_of(const std::uint8_t* row, int x) {
    if constexpr (format == PixelFormat::grey8) {
        return row[x];
    } else if constexpr (format == PixelFormat::yuyv) {
        return row[2 * x];
    } else {
        const std::uint8_t* bgr = row + 3 * x;
        return (3735 * bgr[0] + 19235 * bgr[1] + 9798 * bgr[2] + (1 << 14)) >> 15;
    }
}

}  // namespace disparityd
