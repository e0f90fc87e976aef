// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/block_matcher.h"

#include <algorithm>
#include <array>

#include "kernels/cpu/cost/gradient_kernels.h"
#include "kernels/parallel_rows.h"
#include "kernels/round_up_to_cache_line.h"
#include "kernels/stage_table.h"
#include "kernels/step_clock.h"

namespace disparityd::cpu {

namespace {

constexpr std::array<std::string_view, 1> sad_match_steps = {"sad+wta"};
constexpr std::array<std::string_view, 1> census_match_steps = {"dsi+wta"};
constexpr auto stages_of_sad = sad_stages(sad_match_steps);
constexpr auto stages_of_census = census_stages(census_match_steps);

// A band of SAD begins with the sums of seven rows: lower ones than this are not worth it.
constexpr int min_rows_of_band = 16;

SgmKernels census_kernels(const MatchOptions& options, std::int64_t target) {
    SgmKernels kernels = sgm_kernels(target, options.range.count);
    use_cost(options.cost, target, options.range.count, kernels);
    return kernels;
}

// Costs without a bias: only paths want one.
MatchGeometry geometry_of(const MatcherConfig& config, const SgmKernels& kernels) {
    MatchGeometry geometry = geometry_for(kernels, config.width, config.height, config.options.range);
    geometry.cost_bias = 0;
    return geometry;
}

}  // namespace

BlockMatcher::BlockMatcher(const MatcherConfig& config, const FrameSteps& steps, std::int64_t target, int bands)
    : config_(checked(config)),
      census_kernels_(census_kernels(config.options, target)),
      kernels_(block_kernels(target, config.options.range.count)),
      geometry_(geometry_of(config, census_kernels_)),
      scratch_(steps, config, census_bytes()),
      frame_stages_(steps, config),
      bands_(std::clamp(config.height / min_rows_of_band, 1, bands)),
      bytes_of_band_(round_up_to_cache_line(kernels_.scratch_bytes(geometry_))) {
    band_scratch_ = LargeBuffer(bytes_of_band_ * static_cast<std::size_t>(bands_));
}

std::size_t BlockMatcher::census_bytes() const {
    return config_.options.method == Method::sad ? 0 : geometry_.census.bytes(config_.height);
}

std::span<const StageInfo> BlockMatcher::stages() const {
    return config_.options.method == Method::sad ? std::span<const StageInfo>(stages_of_sad)
                                                 : std::span<const StageInfo>(stages_of_census);
}

void BlockMatcher::run(int stage, const FrameView& frame, Parallel& workers,
                       std::span<std::chrono::nanoseconds> step_times) {
    StepClock clock(step_times);
    switch (stages()[static_cast<std::size_t>(stage)].kind) {
        case StageKind::rectify: frame_stages_.rectify(frame, workers); break;
        case StageKind::census: census(frame, workers); break;
        case StageKind::match: match(frame, workers); break;
        case StageKind::post_process: frame_stages_.post_process(frame, scratch_, workers); break;
    }
    clock.next();
}

void BlockMatcher::census(const FrameView& frame, Parallel& workers) const {
    const CensusPlanes planes(geometry_.census, config_.height,
                              reinterpret_cast<std::uint8_t*>(scratch_.census(frame.scratch).data()));
    parallel_rows(config_.height, workers, [&](Rows rows) {
        census_kernels_.census.left(geometry_, frame.left, {}, planes.left, rows);
        census_kernels_.census.right(geometry_, frame.right, {}, planes.right, rows);
    });
}

void BlockMatcher::match(const FrameView& frame, Parallel& workers) const {
    const WinnerPlanes out{scratch_.matched(frame), frame.confidence, scratch_.left_winner(frame.scratch),
                           scratch_.right_winner(frame.scratch)};
    const PostOptions& post = config_.options.post;
    const CensusPlanes planes(geometry_.census, config_.height,
                              reinterpret_cast<const std::uint8_t*>(scratch_.census(frame.scratch).data()));
    workers.for_each(bands_, [&](int band) {
        const Rows rows{config_.height * band / bands_, config_.height * (band + 1) / bands_};
        auto* memory =
            reinterpret_cast<std::uint8_t*>(band_scratch_.data()) + bytes_of_band_ * static_cast<std::size_t>(band);
        if (config_.options.method == Method::sad) {
            kernels_.sad(geometry_, post, frame.left, frame.right, rows, memory, out);
        } else {
            kernels_.census(geometry_, post, census_kernels_.matching_cost, planes, rows, memory, out);
        }
    });
}

}  // namespace disparityd::cpu
