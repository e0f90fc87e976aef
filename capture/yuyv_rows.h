// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::capture {

/// Writes `pairs` pairs of pixels as YUYV, from a row of luma and two rows of chroma of half its width.
inline void pack_yuyv(const std::uint8_t* luma, const std::uint8_t* u, const std::uint8_t* v, int pairs,
                      std::uint8_t* to) {
    for (int i = 0; i < pairs; ++i) {
        to[4 * i] = luma[2 * i];
        to[4 * i + 1] = u[i];
        to[4 * i + 2] = luma[2 * i + 1];
        to[4 * i + 3] = v[i];
    }
}

}  // namespace disparityd::capture
