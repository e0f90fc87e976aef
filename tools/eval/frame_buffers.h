// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <vector>

#include <opencv2/core.hpp>

#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "obstacles/near_sectors.h"
#include "tools/eval/matcher_result.h"

namespace disparityd::eval {

/// Matches a rectified pair (grey or BGR, equal sizes) `repeat` times, with adaptive_noise at the level that it asks
/// for. Throws as Backend::create does.
MatcherResult run_ours(const Backend& backend, const MatchOptions& options, const cv::Mat& left, const cv::Mat& right,
                       Parallel& workers, int repeat);

/// A rectified pair on its way through a matcher: owns what FrameView refers to. One thread at a time.
class FrameBuffers {
public:
    /// `left` and `right`: grey or BGR, 8 bit, of the matcher's size; the matcher's first stage makes grey planes of
    /// them here, as it does in the pipeline. `matcher` outlives this.
    FrameBuffers(Matcher& matcher, const cv::Mat& left, const cv::Mat& right, Parallel& workers);

    /// Matches the pair from start to end. No allocation.
    void match(Parallel& workers);

    /// Matches the pair at the noise level that it asks for (kernels/noise/match_alone.h), which matches from then on
    /// have, too.
    void match_alone(Parallel& workers);

    /// Matches the pair at a noise level, 0 .. 3, which matches from then on have, too. No allocation.
    void match_at(int noise_level, Parallel& workers);

    const FrameView& view() const { return frame_; }

    /// What the near guard has found; nothing where it is off.
    scan::NearBlocks near() const {
        const DisparityRange range = matcher_.config().options.range;
        return {frame_.near, 16 * (range.first + range.count - 1)};
    }

    /// How long the steps of the last match() took, in the order of the stages after the first and of their steps.
    const std::vector<std::chrono::nanoseconds>& step_times() const { return step_times_; }

private:
    Matcher& matcher_;
    LargeBuffer left_, right_, disparity_, confidence_, near_, scratch_;
    FrameView frame_;
    std::vector<std::chrono::nanoseconds> step_times_;
};

}  // namespace disparityd::eval
