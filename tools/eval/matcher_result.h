// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/options.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// What a matcher makes of a scene.
struct MatcherResult {
    int width = 0;
    int height = 0;
    DisparityRange range;
    std::vector<std::int16_t> d16;  ///< 1/16 px, invalid_disparity(range) = rejected
    double ms = 0;                  ///< median time of a run: matching and post-processing, rectified grey pair given
    std::vector<std::uint8_t> confidence{};  ///< 1 .. 255, 0 = rejected or interpolated; empty for OpenCV's matchers
    std::optional<int> noise_level{};        ///< where it follows the pair's noise

    images::DisparityMap map() const { return {{d16.data(), width, height, width}, range}; }
};

}  // namespace disparityd::eval
