// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "kernels/frame_scratch.h"
#include "kernels/frame_stages.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "kernels/steps.h"

namespace disparityd {

/// The matching chain of docs/algorithm.md made of the steps in a table, one after the other, in the caller's thread:
/// the Parallel given to run() is left alone.
class StepMatcher final : public Matcher {
public:
    /// `steps` outlives the matcher. Throws as Backend::create does.
    StepMatcher(const MatcherConfig& config, const KernelSteps& steps);

    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return scratch_.bytes(); }
    std::span<const StageInfo> stages() const override { return stages_; }
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override;

private:
    Rows rows() const { return {0, config_.height}; }
    void census(const FrameView& frame) const;
    void match(const FrameView& frame, std::span<std::chrono::nanoseconds> step_times) const;
    void match_sad(const FrameView& frame, std::span<std::chrono::nanoseconds> step_times) const;
    template <typename T>
    void choose_winners(Volume<const T> costs, const WinnerSteps<T>& winner, const FrameView& frame) const;

    MatcherConfig config_;
    const MatchingSteps& steps_;
    FrameScratch scratch_;
    FrameStages frame_stages_;
    std::span<const StageInfo> stages_;
    LargeBuffer costs_;  // u16 for SAD, else u8
    LargeBuffer sums_;   // of SGM, u16
    LargeBuffer aggregate_scratch_;
};

}  // namespace disparityd
