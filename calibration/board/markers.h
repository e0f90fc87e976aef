// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board/marker_codes.h"

namespace disparityd::calibration {

/// A marker in an image: the outer corners of its black rim in px, accurate to about a pixel, clockwise from the one
/// that is printed upper left.
struct Marker {
    int number = 0;
    std::array<cv::Point2f, 4> corners;
};

/// Finds markers, each number of the family at most once, in order of the numbers. `image` is grey, 8 bit.
std::vector<Marker> find_markers(const cv::Mat& image, const MarkerFamily& family);

}  // namespace disparityd::calibration
