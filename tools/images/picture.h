// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tools/images/colour_map.h"
#include "tools/images/disparity_map.h"

namespace disparityd::images {

/// The whole range that was searched: the same colours in every picture of a sequence.
ColourScale whole_range(DisparityRange range);

/// What the picture holds, without its most extreme half percents, in whole pixels; the whole range where nothing
/// is valid.
ColourScale fitted(const DisparityMap& map);

/// Which of the two gives the colours.
enum class ColourRange {
    searched,  ///< whole_range()
    frame,     ///< fitted()
};
ColourScale colour_scale(const DisparityMap& map, ColourRange colours);

/// Views of planes as OpenCV sees them; no copy. `colour` planes are BGR, width = 3 x pixels.
cv::Mat grey_view(Plane<const std::uint8_t> plane);
cv::Mat colour_view(Plane<const std::uint8_t> plane);
cv::Mat depth_view(Plane<const std::uint16_t> plane);

/// BGR, rejected pixels in rejected_colour.
cv::Mat colour_disparity(const FloatMap& map, const ColourScale& scale);
cv::Mat colour_disparity(const DisparityMap& map, const ColourScale& scale);

/// What people look at: the left image (grey or BGR) beside the coloured disparity beside its scale. An empty `left`
/// is left out. Higher than the image where the scale's text needs that.
cv::Mat picture(const cv::Mat& left, const DisparityMap& map, const ColourScale& scale, const Metric& metric);

/// Writes "synthetic" into the upper left corner of a BGR picture, readable on any ground: what it shows was drawn, no
/// camera saw it. Left out where the picture is too small for it.
void mark_synthetic(cv::Mat& picture);

}  // namespace disparityd::images
