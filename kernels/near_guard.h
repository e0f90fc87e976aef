// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "kernels/near_plane.h"
#include "kernels/parallel.h"
#include "kernels/steps.h"

namespace disparityd {

/// The configuration of the coarse matcher: step 16 of docs/algorithm.md.
MatcherConfig coarse_config(const MatcherConfig& config);

/// Rejects what is near, step 16 of docs/algorithm.md, in every plane of results that the frame has, and fills in
/// FrameView::near where the frame has it. `coarse`: the disparities of the coarse matcher of this frame.
void reject_near(Plane<const std::int16_t> coarse, DisparityRange coarse_range, DisparityRange range,
                 const FrameView& frame, Rows coarse_rows);

/// The least saturated area, in blocks: what is narrower is bridged by what is around it.
inline constexpr int saturated_columns = 25;
inline constexpr int saturated_rows = 3;

/// Rejects saturated areas, step 16 of docs/algorithm.md, in every plane of results that the frame has. `left`: the
/// coarse left image; `level`: the option, above 0. A matcher has nothing to go by there, and smoothness alone finds
/// one wrong disparity for all of it.
void reject_saturated(Plane<const std::uint8_t> left, int level, DisparityRange range, const FrameView& frame);

/// A matcher whose results leave out what is nearer than its range: a coarse matcher looks for it in a pair of a
/// quarter of the size. Its stages are those of the matcher that it guards; the last one has the step `near-guard`
/// more.
class NearGuard final : public Matcher {
public:
    /// `guarded`: made for `config` without the guard; `coarse`: for coarse_config(config). `steps` outlives this.
    NearGuard(const MatcherConfig& config, const FrameSteps& steps, std::unique_ptr<Matcher> guarded,
              std::unique_ptr<Matcher> coarse);

    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return guarded_->scratch_bytes(); }
    std::span<const StageInfo> stages() const override { return stages_; }
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override;
    bool computes_on_workers() const override { return guarded_->computes_on_workers(); }
    std::string trouble() const override { return guarded_->trouble(); }
    std::string_view substitute() const override { return guarded_->substitute(); }

private:
    void guard(const FrameView& frame, Parallel& workers);

    MatcherConfig config_;
    const FrameSteps& steps_;
    std::unique_ptr<Matcher> guarded_;
    std::unique_ptr<Matcher> coarse_;
    std::vector<std::string_view> last_steps_;
    std::vector<StageInfo> stages_;
    LargeBuffer left_, right_, disparity_, confidence_, scratch_;  // of the coarse pair
    FrameView coarse_view_;
};

/// Returns what `make` makes of the configuration, with a guard around it where the configuration has it on.
template <typename Make>
std::unique_ptr<Matcher> with_near_guard(const MatcherConfig& config, const FrameSteps& steps, const Make& make) {
    if (!config.options.post.near_guard) {
        return make(config);
    }
    MatcherConfig guarded = config;
    guarded.options.post.near_guard = false;
    return std::make_unique<NearGuard>(config, steps, make(guarded), make(coarse_config(config)));
}

}  // namespace disparityd
