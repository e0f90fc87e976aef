// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm_matcher.h"

#include <array>

#include "kernels/step_clock.h"

namespace disparityd::cpu {

namespace {

constexpr std::array<std::string_view, 1> rectify_steps = {"rectify"};
constexpr std::array<std::string_view, 1> census_steps = {"census"};
constexpr std::array<std::string_view, 1> match_steps = {"dsi+aggregate+wta"};
constexpr std::array<std::string_view, 1> post_steps = {"post-process"};
constexpr std::array<StageInfo, 4> all_stages = {
    {{"rectify", rectify_steps}, {"census", census_steps}, {"match", match_steps}, {"post-process", post_steps}}};

}  // namespace

SgmMatcher::SgmMatcher(const MatcherConfig& config, const FrameSteps& steps, std::int64_t target,
                       std::size_t cache_bytes)
    : config_(checked(config)),
      sweeps_(config.width, config.height, config.options, target, cache_bytes),
      scratch_(steps, config, sweeps_.census_bytes()),
      frame_stages_(steps, config) {}

std::span<const StageInfo> SgmMatcher::stages() const {
    return all_stages;
}

void SgmMatcher::run(int stage, const FrameView& frame, Parallel& workers,
                     std::span<std::chrono::nanoseconds> step_times) {
    StepClock clock(step_times);
    const std::span<std::byte> census = scratch_.census(frame.scratch);
    switch (stage) {
        case 0: frame_stages_.rectify(frame, workers); break;
        case 1: sweeps_.census(frame.left, frame.right, census, workers); break;
        case 2:
            sweeps_.match(census, frame.left,
                          {scratch_.matched(frame), frame.confidence, scratch_.left_winner(frame.scratch),
                           scratch_.right_winner(frame.scratch)},
                          workers);
            break;
        default: frame_stages_.post_process(frame, scratch_, workers); break;
    }
    clock.next();
}

}  // namespace disparityd::cpu
