// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/our_matcher.h"

#include <chrono>

#include "tools/eval/frame_buffers.h"
#include "tools/eval/median.h"

namespace disparityd::eval {

using std::chrono::steady_clock;

MatcherResult run_ours(const Backend& backend, const MatchOptions& options, const cv::Mat& left, const cv::Mat& right,
                       Parallel& workers, int repeat) {
    const auto matcher = backend.create({left.cols, left.rows, options});
    FrameBuffers frame(*matcher, left, right, workers);
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) {
        const auto start = steady_clock::now();
        frame.match(workers);
        times.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - start).count());
    }
    const std::int16_t* d16 = frame.view().disparity.data;
    const std::uint8_t* confidence = frame.view().confidence.data;
    return {left.cols,     left.rows,
            options.range, {d16, d16 + left.total()},
            median(times), {confidence, confidence + left.total()}};
}

}  // namespace disparityd::eval
