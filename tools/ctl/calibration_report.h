// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board.h"

namespace disparityd::tools {

/// A view as the report shows it: both eyes side by side, small, grey.
struct ViewPicture {
    cv::Mat image;
    double scale = 1;  ///< of the picture against the captured image
};

ViewPicture shrink(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);

/// One picture for people: every view with its corners and errors, and where in the left image corners were seen.
cv::Mat report_picture(const std::vector<ViewPicture>& pictures, const std::vector<calibration::BoardView>& views,
                       const calibration::BoardCalibration& found);

}  // namespace disparityd::tools
