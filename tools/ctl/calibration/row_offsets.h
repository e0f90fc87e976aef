// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/online/corner_matches.h"

namespace disparityd::tools {

/// Holds the row offsets (left y - right y) of matched corners, without wrong matches. A rotation between the cameras
/// shifts the rows by an amount that changes slowly over the image; a wrong match differs from it by pixels.
struct RowOffsets {
    std::vector<calibration::CornerMatch> agreeing;  ///< in the order given
    double median = 0;                               ///< of their |offset|, px; 0 without any
    double wrong = 0;                                ///< share of all matches that does not agree, 0 .. 1
};

/// Fits a plane to the offsets over the image, robustly (Tukey's weights). It leaves out matches that are farther from
/// the plane than half a pixel and than four standard deviations of the rest. Fewer than 8 matches all agree.
RowOffsets row_offsets(const std::vector<calibration::CornerMatch>& matches);

}  // namespace disparityd::tools
