// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tools/images/disparity_map.h"

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

/// A bar of colours with px labels and, where the metric is known, distances in m; below it the colour of rejected
/// pixels. It has `height` rows, or more where its text needs them.
cv::Mat scale_bar(int height, const ColourScale& scale, const Metric& metric);

/// A colour (BGR) and what it means.
struct LegendRow {
    cv::Vec3b colour;
    std::string meaning;
};

/// The rows below a heading. It has `height` rows of pixels, or more where its text needs them.
cv::Mat colour_legend(int height, const std::string& heading, const std::vector<LegendRow>& rows);

/// BGR pictures beside each other, their upper edges on one line; lower ones are filled up with the background.
cv::Mat side_by_side(const std::vector<cv::Mat>& parts);

}  // namespace disparityd::images
