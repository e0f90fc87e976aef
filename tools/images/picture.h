// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tools/images/disparity_map.h"

namespace disparityd::images {

/// Disparities (px) that get the first and the last colour of colour_map(); beyond them colours are clamped.
struct ColourScale {
    double low = 0;
    double high = 1;
};

/// The whole range that was searched: the same colours in every picture of a sequence.
ColourScale whole_range(DisparityRange range);

/// What the picture holds, without its most extreme half percents, in whole pixels; the whole range where nothing
/// is valid.
ColourScale fitted(const DisparityMap& map);

/// Views of planes as OpenCV sees them; no copy. `colour` planes are BGR, width = 3 x pixels.
cv::Mat grey_view(Plane<const std::uint8_t> plane);
cv::Mat colour_view(Plane<const std::uint8_t> plane);

/// BGR, rejected pixels black.
cv::Mat colour_disparity(const DisparityMap& map, const ColourScale& scale);

/// A bar of colours of the given height with px labels and, where the metric is known, distances in m.
cv::Mat scale_bar(int height, const ColourScale& scale, const Metric& metric);

/// What people look at: the left image (grey or BGR) beside the coloured disparity beside its scale. An empty `left`
/// is left out.
cv::Mat picture(const cv::Mat& left, const DisparityMap& map, const ColourScale& scale, const Metric& metric);

}  // namespace disparityd::images
