// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board/board.h"

namespace disparityd::calibration {

/// An inner corner of a board. Numbers go row by row from the upper left, as printed.
struct NumberedCorner {
    int number = 0;
    cv::Point2f at;  ///< px
};

/// Finds the inner corners of a ChArUco board that lie between two visible markers, in order of their numbers, with
/// subpixel positions. Recognises both layouts of boards with an even number of rows of squares: black upper left
/// square (OpenCV 4.6 and later), or one with a marker. `image` is grey, 8 bit.
std::vector<NumberedCorner> find_charuco_corners(const cv::Mat& image, const Board& board);

}  // namespace disparityd::calibration
