// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kernels/matcher.h"

namespace disparityd::test {

struct Size {
    const char* name;
    int width, height, disparities;
};

/// Medians, in milliseconds.
struct FrameTimes {
    std::vector<std::string> steps;  ///< the matcher's
    std::vector<double> step;
    double frame = 0;    ///< from a raw YUYV frame to results, both in host memory, one frame at a time
    double matched = 0;  ///< of that, from the rectified pair on
};

/// Of a back end with these options, whose range is of size.disparities, with frames in rotation, so that no cache
/// holds the next one.
FrameTimes frame_times(std::string_view backend, const Size& size, const MatchOptions& options, int rounds,
                       Parallel& workers);

/// Milliseconds from one frame to the next of a matcher with two stages, each in a thread of its own as in a pipeline:
/// while one frame is matched the next is rectified.
double two_in_flight(std::string_view backend, const Size& size, const MatchOptions& options, int rounds,
                     Parallel& workers);

}  // namespace disparityd::test
