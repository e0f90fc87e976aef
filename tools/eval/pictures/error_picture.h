// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "tools/eval/matcher_result.h"
#include "tools/eval/scene.h"
#include "tools/images/colour_map.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// Where a disparity map of the scene's size is wrong (BGR): grey by error up to 1 px (black = none), red beyond 1 px,
/// orange beyond 1 px but occluded, blue rejected, dark green without truth.
cv::Mat error_image(const Scene& scene, const images::FloatMap& disparity);

/// What these colours mean, the greys of 0, 0.5 and 1 px first.
const std::vector<images::LegendRow>& error_colours();

/// Left image, coloured disparity, then error_image(); then the scale of the disparity's colours and a legend of the
/// errors'.
cv::Mat error_picture(const Scene& scene, const MatcherResult& result);

}  // namespace disparityd::eval
