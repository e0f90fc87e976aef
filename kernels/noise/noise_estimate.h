// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/image.h"

namespace disparityd {

/// How noisy a pair is, see "Noise levels" in docs/algorithm.md.
struct NoiseEstimate {
    int sigma256 = 0;  ///< standard deviation of one eye's noise in 1/256 grey levels; more in a dark picture
    int blocks = 0;    ///< how many blocks it was found in; of 0 it means nothing
};

/// Estimates the noise of a rectified pair from what both eyes see of the same points, so that noise which neighbouring
/// pixels share counts too. Planes are of one size; `disparity` in 1/16 px, `confidence` 0 where nothing was measured.
/// Scalar code on the calling thread, without allocation: the same bytes everywhere, less than 0.2 ms at any size.
NoiseEstimate estimate_noise(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                             Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence);

}  // namespace disparityd
