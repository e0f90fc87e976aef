// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "kernels/matcher.h"
#include "tools/eval/matcher_result.h"

namespace disparityd::eval {

/// Matches a rectified pair (grey or BGR, equal sizes) `repeat` times. Throws as Backend::create does.
MatcherResult run_ours(const Backend& backend, const MatchOptions& options, const cv::Mat& left, const cv::Mat& right,
                       Parallel& workers, int repeat);

}  // namespace disparityd::eval
