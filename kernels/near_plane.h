// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "kernels/image.h"

namespace disparityd {

/// The side of a block of pixels that share a value in FrameView::near.
inline constexpr int near_block = 4;

/// The value of FrameView::near where nothing was found that is nearer than the range.
inline constexpr std::int16_t not_near = std::numeric_limits<std::int16_t>::min();

/// Returns how many blocks cover so many columns or rows.
constexpr int near_blocks(int pixels) {
    return (pixels + near_block - 1) / near_block;
}

/// Returns how many blocks of FrameView::near are near; 0 where the frame has none.
inline std::ptrdiff_t near_count(Plane<const std::int16_t> near) {
    std::ptrdiff_t count = 0;
    for (int y = 0; y < near.height; ++y) {
        count += near.width - std::count(near.row(y), near.row(y) + near.width, not_near);
    }
    return count;
}

}  // namespace disparityd
