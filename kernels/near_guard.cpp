// SPDX-License-Identifier: Apache-2.0
#include "kernels/near_guard.h"

#include <algorithm>

#include "kernels/frame_stages.h"
#include "kernels/parallel_rows.h"
#include "kernels/step_clock.h"

namespace disparityd {

namespace {

template <typename T>
Plane<T> allocate(LargeBuffer& buffer, const MatcherConfig& config) {
    buffer = LargeBuffer(static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height) * sizeof(T));
    return buffer.plane<T>(config.width, config.height);
}

int last_candidate(DisparityRange range) {
    return range.first + range.count - 1;
}

int quarter_rounded_down(int value) {
    return value >= 0 ? value / near_block : -near_blocks(-value);
}

// All that the range itself has, so that a candidate of it can win, and as near as twice its largest disparity.
DisparityRange coarse_range(DisparityRange range) {
    constexpr int step = 16;
    const int first = quarter_rounded_down(range.first);
    const int last = quarter_rounded_down(std::max(2 * last_candidate(range), last_candidate(range) + 64));
    return {first, std::clamp((last + 1 - first + step - 1) / step * step, 64, max_disparities)};
}

// Clears the pixels of a block in a plane that the frame may lack.
template <typename T>
void fill_block(Plane<T> plane, int block_x, int block_y, T value) {
    if (!plane) {
        return;
    }
    const int x = near_block * block_x;
    const int columns = std::min(near_block, plane.width - x);
    for (int y = near_block * block_y; y < std::min(near_block * (block_y + 1), plane.height); ++y) {
        std::fill_n(plane.row(y) + x, columns, value);
    }
}

void reject_block(const FrameView& frame, DisparityRange range, int block_x, int block_y) {
    fill_block(frame.disparity, block_x, block_y, invalid_disparity(range));
    fill_block(frame.confidence, block_x, block_y, std::uint8_t{0});
    fill_block(frame.depth, block_x, block_y, std::uint16_t{0});
    fill_block(frame.depth_error, block_x, block_y, std::uint16_t{0});
}

bool is_saturated(Plane<const std::uint8_t> left, int level, int x, int top) {
    for (int y = top; y < top + saturated_rows; ++y) {
        if (left.at(x, y) < level) {
            return false;
        }
    }
    return true;
}

void reject_run(const FrameView& frame, DisparityRange range, int begin, int end, int top) {
    for (int y = top; y < top + saturated_rows; ++y) {
        for (int x = begin; x < end; ++x) {
            reject_block(frame, range, x, y);
        }
    }
}

}  // namespace

MatcherConfig coarse_config(const MatcherConfig& config) {
    MatcherConfig coarse{near_blocks(config.width), near_blocks(config.height),
                         preset_options(Preset::obstacles, coarse_range(config.options.range))};
    coarse.options.post.near_guard = false;
    coarse.options.adaptive_noise = false;  // the mean of 16 pixels has a quarter of the noise
    coarse.options.post.speckle_size = 20;
    return coarse;
}

void reject_near(Plane<const std::int16_t> coarse, DisparityRange coarse_range, DisparityRange range,
                 const FrameView& frame, Rows coarse_rows) {
    const std::int16_t coarse_invalid = invalid_disparity(coarse_range);
    for (int y = coarse_rows.first; y < coarse_rows.last; ++y) {
        if (frame.near) {
            std::fill_n(frame.near.row(y), frame.near.width, not_near);
        }
        for (int x = 0; x < coarse.width; ++x) {
            const int value = near_block * coarse.at(x, y);
            if (coarse.at(x, y) == coarse_invalid || value < 16 * last_candidate(range)) {
                continue;
            }
            if (frame.near) {
                frame.near.at(x, y) = static_cast<std::int16_t>(value);
            }
            reject_block(frame, range, x, y);
        }
    }
}

void reject_saturated(Plane<const std::uint8_t> left, int level, DisparityRange range, const FrameView& frame) {
    for (int top = 0; top + saturated_rows <= left.height; ++top) {
        int begin = 0;
        for (int x = 0; x <= left.width; ++x) {
            if (x < left.width && is_saturated(left, level, x, top)) {
                continue;
            }
            if (x - begin >= saturated_columns) {
                reject_run(frame, range, begin, x, top);
            }
            begin = x + 1;
        }
    }
}

NearGuard::NearGuard(const MatcherConfig& config, const FrameSteps& steps, std::unique_ptr<Matcher> guarded,
                     std::unique_ptr<Matcher> coarse)
    : config_(config),
      steps_(steps),
      guarded_(std::move(guarded)),
      coarse_(std::move(coarse)),
      last_steps_(guarded_->stages().back().steps.begin(), guarded_->stages().back().steps.end()),
      stages_(guarded_->stages().begin(), guarded_->stages().end()) {
    last_steps_.emplace_back("near-guard");
    stages_.back().steps = last_steps_;
    coarse_view_.left = allocate<std::uint8_t>(left_, coarse_->config());
    coarse_view_.right = allocate<std::uint8_t>(right_, coarse_->config());
    coarse_view_.disparity = allocate<std::int16_t>(disparity_, coarse_->config());
    coarse_view_.confidence = allocate<std::uint8_t>(confidence_, coarse_->config());
    scratch_ = LargeBuffer(coarse_->scratch_bytes());
    coarse_view_.scratch = {scratch_.data(), scratch_.size()};
}

void NearGuard::run(int stage, const FrameView& frame, Parallel& workers,
                    std::span<std::chrono::nanoseconds> step_times) {
    if (static_cast<std::size_t>(stage) + 1 < stages_.size()) {
        guarded_->run(stage, frame, workers, step_times);
        return;
    }
    guarded_->run(stage, frame, workers, step_times.first(step_times.size() - 1));
    StepClock clock(step_times.last(1));
    guard(frame, workers);
    clock.next();
}

void NearGuard::guard(const FrameView& frame, Parallel& workers) {
    const MatcherConfig& coarse = coarse_->config();
    parallel_rows(coarse.height, workers, [&](Rows rows) {
        steps_.shrink(frame.left, coarse_view_.left, rows);
        steps_.shrink(frame.right, coarse_view_.right, rows);
    });
    match_pair(*coarse_, coarse_view_, workers);
    reject_near(coarse_view_.disparity, coarse.options.range, config_.options.range, frame, {0, coarse.height});
    if (const int level = config_.options.post.saturated_level; level > 0) {
        reject_saturated(coarse_view_.left, level, config_.options.range, frame);
    }
}

}  // namespace disparityd
