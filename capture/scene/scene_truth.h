// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/rectification.h"

namespace disparityd::capture {

/// Exact ground truth of one frame, for each pixel of the rectified left image, row by row.
struct SceneTruth {
    std::vector<float> disparity;       ///< px; NaN where nothing is seen
    std::vector<std::uint8_t> visible;  ///< 1 where the right eye sees the same point
    std::vector<std::uint8_t> thin;     ///< 1 on a pole or a wire
};

/// Casts the rays of the rectified left camera into the scene at frame `sequence` of the source `uri` ("scene:...").
/// `rectification` must have been made from the scene's own calibration. Throws as open_source() does for a bad URI.
SceneTruth scene_truth(const std::string& uri, std::uint64_t sequence, const calibration::Rectification& rectification);

}  // namespace disparityd::capture
