// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/frame_scratch.h"
#include "kernels/matcher.h"
#include "kernels/steps.h"

namespace disparityd {

/// The configuration itself; throws as Backend::create does when it cannot be matched with.
const MatcherConfig& checked(const MatcherConfig& config);

/// Throws std::invalid_argument when the region that the frame's rectifier takes does not lie inside the raw frame.
void check_fits(const FrameView& frame);

/// Step 13: computes the planes of depth and depth error that the frame has, from its disparity and confidence.
void write_depth(const FrameSteps& steps, DisparityRange range, const FrameView& frame, Rows rows);

/// The first and the last stage, which are the same however a pair is matched.
class FrameStages {
public:
    /// `steps` outlives this.
    FrameStages(const FrameSteps& steps, const MatcherConfig& config) : steps_(steps), config_(config) {}

    void rectify(const FrameView& frame, Parallel& workers) const;
    /// What the census of a frame with a noise level above 0 is made from.
    void smooth(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const;
    void post_process(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const;

private:
    void take_median(const FrameView& frame, const FrameScratch& scratch, Plane<std::int16_t> out, Rows rows) const;
    void filter(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const;
    void fill(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const;

    const FrameSteps& steps_;
    MatcherConfig config_;
};

}  // namespace disparityd
