// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/image.h"

namespace disparityd::empty_result {

/// Where a point of the left image lies in the right one, in px of the whole image.
struct CoarseMatch {
    double disparity = 0;  ///< left x - right x
    double rows = 0;       ///< left y - right y
};

/// Matches corners as self-calibration does (calibration/online/corner_matches.h), on reduced images and far beyond any
/// range: disparities up to half the width to both sides, and several rows up and down. Some 0.2 s. The images have one
/// size.
std::vector<CoarseMatch> coarse_matches(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);

}  // namespace disparityd::empty_result
