// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cpu/sgm/sgm_sweeps.h"
#include "kernels/frame_scratch.h"
#include "kernels/frame_stages.h"
#include "kernels/matcher.h"

namespace disparityd::cpu {

/// The matching chain for SGM; cost, aggregation and winners are one step.
class SgmMatcher final : public Matcher {
public:
    /// `steps` (first and last stage) outlives the matcher; target and cache_bytes as SgmSweeps has them.
    SgmMatcher(const MatcherConfig& config, const FrameSteps& steps, std::int64_t target, std::size_t cache_bytes);

    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return scratch_.bytes(); }
    std::span<const StageInfo> stages() const override;
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override;

private:
    MatcherConfig config_;
    SgmSweeps sweeps_;
    FrameScratch scratch_;
    FrameStages frame_stages_;
};

}  // namespace disparityd::cpu
