// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace disparityd::images {

/// 256 colours (BGR) from far, dark violet, over blue and green to near, light yellow. Lightness rises evenly as the
/// eye sees it, so that the order also shows in grey and to the colour-blind; no entry is grey, which marks rejected
/// pixels.
const std::array<cv::Vec3b, 256>& colour_map();

/// What rejected pixels look like: a grey that no disparity has.
inline const cv::Vec3b rejected_colour(128, 128, 128);

/// Disparities (px) that get the first and the last colour of colour_map(); beyond them colours are clamped.
struct ColourScale {
    double low = 0;
    double high = 1;
};

/// The colour of a disparity.
cv::Vec3b colour_of(double disparity, const ColourScale& scale);

}  // namespace disparityd::images
