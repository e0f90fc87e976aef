// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/rectification.h"
#include "kernels/raw_image.h"
#include "tools/ctl/calibration/row_offsets.h"

namespace disparityd::tools {

/// Holds a frame rectified in one way, and the corners that both of its eyes have.
class RowsOfPair {
public:
    /// `range`: the disparities at which corners are searched.
    RowsOfPair(const RawImage& frame, const calibration::Rectification& rectification, DisparityRange range);

    /// Returns the corners, without wrong matches, and how far their rows are apart.
    const RowOffsets& rows() const { return rows_; }

    cv::Mat left() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(left_.data())}; }
    cv::Mat right() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(right_.data())}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    RowOffsets rows_;
};

/// Draws six places of the image, magnified, left eye beside right eye: on the left as rectified before, on the right
/// as after. A line marks the left corner's row, a cross the corner in the right eye.
cv::Mat rows_picture(const RowsOfPair& before, const RowsOfPair& after);

}  // namespace disparityd::tools
