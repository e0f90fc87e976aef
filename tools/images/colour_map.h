// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace disparityd::images {

/// 256 colours (BGR) from far, blue, over green to near, red: the map "turbo", as on the page of disparity-web and in
/// Foxglove. It has no black, which marks rejected pixels.
const std::array<cv::Vec3b, 256>& colour_map();

inline const cv::Vec3b rejected_colour(0, 0, 0);

/// Disparities (px) that get the first and the last colour of colour_map(); beyond them colours are clamped.
struct ColourScale {
    double low = 0;
    double high = 1;
};

/// The colour of a disparity.
cv::Vec3b colour_of(double disparity, const ColourScale& scale);

}  // namespace disparityd::images
