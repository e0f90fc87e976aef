// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "tools/eval/matcher_result.h"

namespace disparityd::eval {

/// OpenCV's matchers, to compare with. Parameters are those of OpenCV's own sample (stereo_match): StereoBM block 9,
/// cap 31, texture 10, uniqueness 15; StereoSGBM block 3, cap 63, P1 = 8 x 9, P2 = 32 x 9, uniqueness 10; both speckle
/// window 100, range 32, disp12MaxDiff 1.
enum class OpencvMethod { bm, sgbm_hh, sgbm_3way };

const std::vector<OpencvMethod>& opencv_methods();
std::string name(OpencvMethod method);

/// The matcher with these parameters; its compute() takes grey images.
cv::Ptr<cv::StereoMatcher> create_opencv(OpencvMethod method, DisparityRange range);

/// BGR made grey; grey as it is.
cv::Mat grey(const cv::Mat& image);

/// Matches a rectified pair `repeat` times on `threads` threads.
MatcherResult run_opencv(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                         int threads, int repeat);

/// OpenCV's matcher without the two handicaps that are no matter of matching: it leaves out the columns whose
/// candidates reach beyond the right image, and it leaves holes.
///
/// Both images are padded by the range (the border replicated) and the result is cropped, so that every column is
/// matched; then steps 9 (median 3x3) and 11 (interpolation) of docs/algorithm.md are applied. What the right image
/// sees, which step 11 asks for, comes from matching the mirrored pair. `ms` is the time of one matching alone.
MatcherResult run_opencv_fairly(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                                int threads, int repeat);

}  // namespace disparityd::eval
