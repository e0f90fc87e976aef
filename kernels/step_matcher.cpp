// SPDX-License-Identifier: Apache-2.0
#include "kernels/step_matcher.h"

#include <algorithm>
#include <array>

#include "kernels/noise/noise_level.h"
#include "kernels/stage_table.h"
#include "kernels/step_clock.h"

namespace disparityd {

namespace {

using std::chrono::nanoseconds;

constexpr std::array<std::string_view, 2> sad_match_steps = {"sad", "wta"};
constexpr std::array<std::string_view, 2> census_match_steps = {"dsi", "wta"};
constexpr std::array<std::string_view, 3> sgm_match_steps = {"dsi", "aggregate", "wta"};
constexpr auto stages_of_sad = sad_stages(sad_match_steps);
constexpr auto stages_of_census = census_stages(census_match_steps);
constexpr auto stages_of_sgm = census_stages(sgm_match_steps);

std::span<const StageInfo> stages_of(Method method) {
    switch (method) {
        case Method::sad: return stages_of_sad;
        case Method::census: return stages_of_census;
        case Method::sgm: break;
    }
    return stages_of_sgm;
}

std::size_t candidates(const MatcherConfig& config) {
    return static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height) *
           static_cast<std::size_t>(config.options.range.count);
}

template <typename T>
Volume<T> volume(const LargeBuffer& buffer, const MatcherConfig& config) {
    return {reinterpret_cast<T*>(buffer.data()), config.width, config.height, config.options.range.count};
}

}  // namespace

StepMatcher::StepMatcher(const MatcherConfig& config, const KernelSteps& steps)
    : config_(checked(config)),
      steps_(steps.matching),
      scratch_(steps.frame, config),
      frame_stages_(steps.frame, config),
      stages_(stages_of(config.options.method)),
      costs_(candidates(config) * (config.options.method == Method::sad ? sizeof(std::uint16_t) : 1)) {
    if (config.options.method == Method::sgm) {
        sums_ = LargeBuffer(candidates(config) * sizeof(std::uint16_t));
        aggregate_scratch_ =
            LargeBuffer(steps_.aggregate_scratch(config.width, config.height, config.options.range.count));
    }
}

void StepMatcher::run(int stage, const FrameView& frame, Parallel& /*workers*/, std::span<nanoseconds> step_times) {
    const StageKind kind = stages_[static_cast<std::size_t>(stage)].kind;
    if (kind == StageKind::match) {
        config_.options.method == Method::sad ? match_sad(frame, step_times) : match(frame, step_times);
        return;
    }
    Serial serial;
    StepClock clock(step_times);
    if (kind == StageKind::rectify) {
        frame_stages_.rectify(frame, serial);
    } else if (kind == StageKind::census) {
        census(frame);
    } else {
        frame_stages_.post_process(frame, scratch_, serial);
    }
    clock.next();
}

void StepMatcher::census(const FrameView& frame) const {
    if (const int level = noise_level_of(config_.options, frame); level > 0) {
        Serial serial;
        frame_stages_.smooth(frame, scratch_, serial);
        const int coarseness = census_coarseness(level);
        steps_.noisy_census(frame.left, scratch_.smoothed_left(frame.scratch), coarseness,
                            scratch_.left_census(frame.scratch), rows());
        steps_.noisy_census(frame.right, scratch_.smoothed_right(frame.scratch), coarseness,
                            scratch_.right_census(frame.scratch), rows());
        return;
    }
    const CensusSteps& steps = steps_.of(config_.options.cost);
    steps.census(frame.left, scratch_.left_census(frame.scratch), rows());
    steps.census(frame.right, scratch_.right_census(frame.scratch), rows());
}

void StepMatcher::match_sad(const FrameView& frame, std::span<nanoseconds> step_times) const {
    StepClock clock(step_times);
    const auto costs = volume<std::uint16_t>(costs_, config_);
    steps_.sad(frame.left, frame.right, config_.options.range, costs, rows());
    clock.next();
    choose_winners<std::uint16_t>(costs, steps_.winner_u16, frame);
    clock.next();
}

void StepMatcher::match(const FrameView& frame, std::span<nanoseconds> step_times) const {
    StepClock clock(step_times);
    const auto costs = volume<std::uint8_t>(costs_, config_);
    steps_.of(config_.options.cost)
        .matching_cost(scratch_.left_census(frame.scratch), scratch_.right_census(frame.scratch), config_.options.range,
                       costs, rows());
    clock.next();
    if (config_.options.method == Method::sgm) {
        Serial serial;
        const auto sums = volume<std::uint16_t>(sums_, config_);
        const int level = noise_level_of(config_.options, frame);
        const Plane<const std::uint8_t> guide = level > 0 ? scratch_.smoothed_left(frame.scratch) : frame.left;
        steps_.aggregate(costs, guide, at_noise_level(config_.options, level).sgm, sums,
                         {aggregate_scratch_.data(), aggregate_scratch_.size()}, serial);
        clock.next();
        choose_winners<std::uint16_t>(sums, steps_.winner_u16, frame);
    } else {
        choose_winners<std::uint8_t>(costs, steps_.winner_u8, frame);
    }
    clock.next();
}

template <typename T>
void StepMatcher::choose_winners(Volume<const T> costs, const WinnerSteps<T>& winner, const FrameView& frame) const {
    const MatchOptions options = at_noise_level(config_.options, noise_level_of(config_.options, frame));
    const Plane<std::int16_t> left = scratch_.left_winner(frame.scratch);
    const Plane<std::int16_t> right = scratch_.right_winner(frame.scratch);
    const Plane<std::int16_t> disparity = scratch_.matched(frame);
    // Row by row, so that the costs are still in the cache for the second and third look.
    for (int y = 0; y < config_.height; ++y) {
        const Rows row{y, y + 1};
        winner.left(costs, options.range, options.post.subpixel, left, disparity, row);
        winner.right(costs, options.range, right, row);
        winner.local_extrema(costs, options.range, options.post, left, disparity, frame.confidence, row);
    }
}

}  // namespace disparityd
