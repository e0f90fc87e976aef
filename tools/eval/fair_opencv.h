// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "tools/eval/matcher_result.h"
#include "tools/eval/opencv_matcher.h"

namespace disparityd::eval {

/// OpenCV's matcher without the two handicaps that are no matter of matching: it leaves out the columns whose
/// candidates reach beyond the right image, and it leaves holes.
///
/// Both images are padded by the range (the border replicated) and the result is cropped, so that every column is
/// matched; then steps 9 (median 3x3) and 11 (interpolation) of docs/algorithm.md are applied. What the right image
/// sees, which step 11 asks for, comes from matching the mirrored pair. `ms` is the time of one matching alone.
MatcherResult run_opencv_fairly(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                                int threads, int repeat);

}  // namespace disparityd::eval
