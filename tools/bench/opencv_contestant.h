// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/bench/our_contestant.h"
#include "tools/eval/opencv_matcher.h"

namespace disparityd::bench {

/// One of OpenCV's matchers with the parameters of opencv_matcher.h: a contestant for each number of threads (one only
/// where the algorithm runs on one thread). Matches the first frame.
Contestants make_opencv(const StereoPair& pair, eval::OpencvMethod method, int d_min, const std::vector<int>& threads);

/// "opencv/bm", "opencv/hh", "opencv/3way".
std::string contestant_name(eval::OpencvMethod method);

/// What OpenCV was built with and what it leaves out: lines for the reader of a comparison.
std::vector<std::string> describe_opencv();

}  // namespace disparityd::bench
