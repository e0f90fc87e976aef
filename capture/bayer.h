// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

namespace disparityd::capture {

/// Returns OpenCV's conversion to BGR of a Bayer pattern whose blue pixel of four is in this row and column, 0 or 1.
/// OpenCV names patterns by the four pixels of which the second row and column are the first.
constexpr int demosaicing(int blue_row, int blue_column) {
    if (blue_row == 0) {
        return blue_column == 0 ? cv::COLOR_BayerRG2BGR : cv::COLOR_BayerGR2BGR;
    }
    return blue_column == 0 ? cv::COLOR_BayerGB2BGR : cv::COLOR_BayerBG2BGR;
}

}  // namespace disparityd::capture
