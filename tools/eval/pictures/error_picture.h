// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tools/eval/matcher_result.h"
#include "tools/eval/scene.h"

namespace disparityd::eval {

/// Left image, coloured disparity, then where it is wrong: grey by error up to 1 px (black = none), red beyond 1 px,
/// orange beyond 1 px but occluded, blue rejected, dark green without truth; then the scale of the
/// disparity's colours and a legend of the errors'.
cv::Mat error_picture(const Scene& scene, const MatcherResult& result);

}  // namespace disparityd::eval
