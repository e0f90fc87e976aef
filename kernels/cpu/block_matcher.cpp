// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/block_matcher.h"

#include <algorithm>
#include <array>

#include "kernels/over_rows.h"
#include "kernels/step_clock.h"
#include "kernels/whole_lines.h"

namespace disparityd::cpu {

namespace {

constexpr std::array<std::string_view, 1> rectify_steps = {"rectify"};
constexpr std::array<std::string_view, 1> census_steps = {"census"};
constexpr std::array<std::string_view, 1> sad_match_steps = {"sad+wta"};
constexpr std::array<std::string_view, 1> census_match_steps = {"dsi+wta"};
constexpr std::array<std::string_view, 1> post_steps = {"post-process"};
constexpr std::array<StageInfo, 3> sad_stages = {
    {{"rectify", rectify_steps}, {"match", sad_match_steps}, {"post-process", post_steps}}};
constexpr std::array<StageInfo, 4> census_stages = {{{"rectify", rectify_steps},
                                                     {"census", census_steps},
                                                     {"match", census_match_steps},
                                                     {"post-process", post_steps}}};

// A band of SAD begins with the sums of seven rows: lower ones than this are not worth it.
constexpr int least_rows_of_band = 16;

// Costs as they are: only paths want them raised.
SgmGeometry geometry_of(const MatcherConfig& config, const SgmKernels& kernels) {
    SgmGeometry geometry = geometry_for(kernels, config.width, config.height, config.options.range);
    geometry.raised_cost = 0;
    return geometry;
}

}  // namespace

BlockMatcher::BlockMatcher(const MatcherConfig& config, const FrameSteps& steps, std::int64_t target, int bands)
    : config_(checked(config)),
      census_kernels_(sgm_kernels(target, config.options.range.count)),
      kernels_(block_kernels(target, config.options.range.count)),
      geometry_(geometry_of(config, census_kernels_)),
      scratch_(steps, config, census_bytes()),
      frame_stages_(steps, config),
      bands_(std::clamp(config.height / least_rows_of_band, 1, bands)),
      bytes_of_band_(whole_lines(kernels_.scratch_bytes(geometry_))) {
    band_scratch_ = LargeBuffer(bytes_of_band_ * static_cast<std::size_t>(bands_));
}

std::size_t BlockMatcher::census_bytes() const {
    return config_.options.method == Method::sad ? 0 : geometry_.census.bytes(config_.height);
}

std::span<const StageInfo> BlockMatcher::stages() const {
    return config_.options.method == Method::sad ? std::span<const StageInfo>(sad_stages)
                                                 : std::span<const StageInfo>(census_stages);
}

void BlockMatcher::run(int stage, const FrameView& frame, Parallel& workers,
                       std::span<std::chrono::nanoseconds> step_times) {
    StepClock clock(step_times);
    const std::string_view name = stages()[static_cast<std::size_t>(stage)].name;
    if (name == "rectify") {
        frame_stages_.rectify(frame, workers);
    } else if (name == "census") {
        census(frame, workers);
    } else if (name == "match") {
        match(frame, workers);
    } else {
        frame_stages_.post_process(frame, scratch_, workers);
    }
    clock.next();
}

void BlockMatcher::census(const FrameView& frame, Parallel& workers) const {
    const CensusPlanes planes(geometry_.census, config_.height,
                              reinterpret_cast<std::uint8_t*>(scratch_.census(frame.scratch).data()));
    over_rows(config_.height, workers, [&](Rows rows) {
        census_kernels_.census_left(geometry_, frame.left, planes.left, rows);
        census_kernels_.census_right(geometry_, frame.right, planes.right, rows);
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
            kernels_.census(geometry_, post, planes, rows, memory, out);
        }
    });
}

}  // namespace disparityd::cpu
