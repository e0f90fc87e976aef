// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/corner_matches.h"
#include "capture/rectification.h"
#include "kernels/raw_image.h"

namespace disparityd::tools {

/// A frame as one rectification shows it, and the corners that both of its eyes have.
class RowsOfPair {
public:
    /// `range`: the disparities that corners are looked for in.
    RowsOfPair(const RawImage& frame, const capture::Rectification& rectification, DisparityRange range);

    const std::vector<calibration::CornerMatch>& matches() const { return matches_; }

    /// Median of |left y - right y| of the corners, px; 0 without any.
    double error() const;

    cv::Mat left() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(left_.data())}; }
    cv::Mat right() const { return {height_, width_, CV_8U, const_cast<std::uint8_t*>(right_.data())}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::vector<calibration::CornerMatch> matches_;
};

/// For people: six places of the image, magnified, left eye beside right eye, on the left as rectified before and on
/// the right as after; a line along the left corner's row, a cross where the right eye has the corner.
cv::Mat rows_picture(const RowsOfPair& before, const RowsOfPair& after);

}  // namespace disparityd::tools
