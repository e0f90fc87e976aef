// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board/board.h"

namespace disparityd::tools {

/// Holds a view for the report: both eyes side by side, small, grey.
struct ViewPicture {
    cv::Mat image;
    double scale = 1;   ///< of the picture against the captured image
    std::string frame;  ///< where it came from: the names of its files, or "frame N"
};

ViewPicture shrink(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right);

/// Returns one line on the coverage of the image: "corners in 7 of 9 parts of the image: ...".
std::string coverage_verdict(const calibration::Coverage& covered);

/// Draws one picture: on top the corners seen in the left image, the result and what is missing
/// (calibration::missing_views()); below every view with its corners, its files and its errors.
cv::Mat report_picture(const std::vector<ViewPicture>& pictures, const std::vector<calibration::BoardView>& views,
                       const calibration::BoardCalibration& found, const std::vector<std::string>& missing);

}  // namespace disparityd::tools
