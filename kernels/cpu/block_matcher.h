// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cpu/block_kernels.h"
#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/frame_scratch.h"
#include "kernels/frame_stages.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"

namespace disparityd::cpu {

/// The matching chain for SAD and CENSUS: bands of rows, each from costs to winners without a volume in between.
class BlockMatcher final : public Matcher {
public:
    /// `steps` (first and last stage) outlives the matcher. `bands`: how many workers it can make use of.
    BlockMatcher(const MatcherConfig& config, const FrameSteps& steps, std::int64_t target, int bands);

    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return scratch_.bytes(); }
    std::span<const StageInfo> stages() const override;
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override;

private:
    void census(const FrameView& frame, Parallel& workers) const;
    void match(const FrameView& frame, Parallel& workers) const;
    std::size_t census_bytes() const;

    MatcherConfig config_;
    SgmKernels census_kernels_;
    BlockKernels kernels_;
    MatchGeometry geometry_;
    FrameScratch scratch_;
    FrameStages frame_stages_;
    int bands_;
    LargeBuffer band_scratch_;
    std::size_t bytes_of_band_;
};

}  // namespace disparityd::cpu
