// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board.h"

namespace disparityd::calibration {

/// An inner corner of a board by its number: row by row from the upper left, as printed.
struct NumberedCorner {
    int number = 0;
    cv::Point2f at;  ///< px
};

/// The inner corners of a ChArUco board that lie between two markers which are seen, in order of their numbers, to a
/// small part of a pixel. Boards of OpenCV 4.6 and later, whose upper left square is black, and older ones of an even
/// number of rows of squares, where it has a marker, are told apart by what is seen. `image` is grey, 8 bit.
std::vector<NumberedCorner> find_charuco_corners(const cv::Mat& image, const Board& board);

}  // namespace disparityd::calibration
