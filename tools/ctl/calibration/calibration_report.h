// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board/board.h"
#include "calibration/board/verdict.h"

namespace disparityd::tools {

/// Holds a view for the report: both eyes side by side, small, grey.
struct ViewPicture {
    cv::Mat image;
    double scale = 1;   ///< of the picture against the captured image
    std::string frame;  ///< where it came from: the names of its files, or "frame N"
};

ViewPicture shrink(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);

/// Returns one line on what the boards have covered: "the boards covered 74 % of the left eye's image, 71 % of ...".
std::string coverage_line(const calibration::Coverage& coverage);

/// Draws one picture: on top the corners seen in both eyes' images, the result, the verdict and its reasons; below
/// every view with its corners, its files and its errors, those that were left out at the end. `pictures` and `views`:
/// all that were taken.
cv::Mat report_picture(const std::vector<ViewPicture>& pictures, const std::vector<calibration::BoardView>& views,
                       const calibration::CheckedCalibration& checked);

}  // namespace disparityd::tools
