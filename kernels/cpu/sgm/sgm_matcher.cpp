// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sgm_matcher.h"

#include <array>

#include "kernels/noise/noise_level.h"
#include "kernels/stage_table.h"
#include "kernels/step_clock.h"

namespace disparityd::cpu {

namespace {

constexpr std::array<std::string_view, 1> match_steps = {"dsi+aggregate+wta"};
constexpr auto all_stages = census_stages(match_steps);

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
    const int level = noise_level_of(config_.options, frame);
    const std::span<std::byte> census = scratch_.census(frame.scratch);
    switch (all_stages[static_cast<std::size_t>(stage)].kind) {
        case StageKind::rectify: frame_stages_.rectify(frame, workers); break;
        case StageKind::census:
            if (level == 0) {
                sweeps_.census(frame.left, frame.right, census, workers);
                break;
            }
            frame_stages_.smooth(frame, scratch_, workers);
            sweeps_.noisy_census({frame.left, frame.right, scratch_.smoothed_left(frame.scratch),
                                  scratch_.smoothed_right(frame.scratch)},
                                 census_coarseness(level), census, workers);
            break;
        case StageKind::match:
            sweeps_.match(census, level == 0 ? frame.left : scratch_.smoothed_left(frame.scratch),
                          at_noise_level(config_.options, level),
                          {scratch_.matched(frame), frame.confidence, scratch_.left_winner(frame.scratch),
                           scratch_.right_winner(frame.scratch)},
                          workers);
            break;
        case StageKind::post_process: frame_stages_.post_process(frame, scratch_, workers); break;
    }
    clock.next();
}

}  // namespace disparityd::cpu
