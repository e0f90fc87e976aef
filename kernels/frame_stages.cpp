// SPDX-License-Identifier: Apache-2.0
#include "kernels/frame_stages.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "kernels/fill_limit.h"
#include "kernels/noise/noise_level.h"
#include "kernels/parallel_rows.h"
#include "kernels/steps.h"

namespace disparityd {

void check_fits(const FrameView& frame) {
    const Rectifier& rectifier = *frame.rectifier;
    const bool fits = rectifier.mapped || (rectifier.crop_x >= 0 && rectifier.crop_y >= 0 &&
                                           rectifier.crop_x <= frame.raw.eye_width - frame.left.width &&
                                           rectifier.crop_y <= frame.raw.height - frame.left.height);
    if (!fits) {
        throw std::invalid_argument("region of " + std::to_string(frame.left.width) + "x" +
                                    std::to_string(frame.left.height) + " at (" + std::to_string(rectifier.crop_x) +
                                    ", " + std::to_string(rectifier.crop_y) + ") does not lie inside the frame's " +
                                    std::to_string(frame.raw.eye_width) + "x" + std::to_string(frame.raw.height));
    }
}

const MatcherConfig& checked(const MatcherConfig& config) {
    if (config.width < 1 || config.width > max_side || config.height < 1 || config.height > max_side) {
        throw std::invalid_argument("image size " + std::to_string(config.width) + "x" + std::to_string(config.height) +
                                    ": allowed is 1 to " + std::to_string(max_side) + " each");
    }
    const std::string found = validate(config.options);
    if (!found.empty()) {
        throw std::invalid_argument(found);
    }
    return config;
}

void write_depth(const FrameSteps& steps, DisparityRange range, const FrameView& frame, Rows rows) {
    if (frame.depth) {
        steps.depth(frame.disparity, invalid_disparity(range), frame.depth_scale, frame.depth, rows);
    }
    if (frame.depth_error) {
        const DepthErrorScale scale =
            depth_error_scale(frame.depth_scale.k, frame.depth_scale.offset16, frame.subpixel_error);
        steps.depth_error(frame.disparity, frame.confidence, scale, frame.depth_error, rows);
    }
}

void FrameStages::rectify(const FrameView& frame, Parallel& workers) const {
    check_fits(frame);
    parallel_rows(config_.height, workers, [&](Rows rows) {
        steps_.rectify(frame.raw, Eye::left, *frame.rectifier, frame.left, rows);
        steps_.rectify(frame.raw, Eye::right, *frame.rectifier, frame.right, rows);
        if (frame.left_colour) {
            steps_.rectify_colour(frame.raw, Eye::left, *frame.rectifier, frame.left_colour, rows);
        }
        if (frame.right_colour) {
            steps_.rectify_colour(frame.raw, Eye::right, *frame.rectifier, frame.right_colour, rows);
        }
    });
}

void FrameStages::smooth(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const {
    parallel_rows(config_.height, workers, [&](Rows rows) {
        steps_.smooth(frame.left, scratch.smoothed_left(frame.scratch), rows);
        steps_.smooth(frame.right, scratch.smoothed_right(frame.scratch), rows);
    });
}

void FrameStages::post_process(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const {
    const PostOptions& post = config_.options.post;
    if (post.left_right_check) {
        parallel_rows(config_.height, workers, [&](Rows rows) {
            steps_.left_right(scratch.left_winner(frame.scratch), scratch.right_winner(frame.scratch),
                              config_.options.range, scratch.matched(frame), rows);
        });
    }
    filter(frame, scratch, workers);
    fill(frame, scratch, workers);
}

// The median of step 9, or without one what matching found.
void FrameStages::take_median(const FrameView& frame, const FrameScratch& scratch, Plane<std::int16_t> out,
                              Rows rows) const {
    const Plane<std::int16_t> matched = scratch.matched(frame);
    if (const int size = config_.options.post.median; size > 0) {
        steps_.median(matched, invalid_disparity(config_.options.range), size, out, rows);
        return;
    }
    for (int y = rows.first; y < rows.last; ++y) {
        std::copy_n(matched.row(y), matched.width, out.row(y));
    }
}

// Steps 9 and 10, and what follows from measured disparities alone. Each time that workers are woken takes as long as
// many rows, so that what can go on with a row does.
void FrameStages::filter(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const {
    const PostOptions& post = config_.options.post;
    const std::int16_t invalid = invalid_disparity(config_.options.range);
    const Plane<std::int16_t> filtered = scratch.filtered(frame);
    const bool by_region = filters_regions(post);
    const bool complete = !post.interpolate && post.guided_median == 0;
    const auto finish = [&](Rows rows) {
        steps_.finish_confidence(filtered, invalid, calibrates_confidence(config_.options), frame.confidence, rows);
        if (complete) {
            write_depth(steps_, config_.options.range, frame, rows);
        }
    };
    const bool votes = noise_level_of(config_.options, frame) > 0;
    const Plane<std::int16_t> before_vote = scratch.before_vote(frame.scratch);
    if (votes) {
        parallel_rows(config_.height, workers, [&](Rows rows) { take_median(frame, scratch, before_vote, rows); });
    }
    if (votes || post.median > 0) {
        parallel_rows(config_.height, workers, [&](Rows rows) {
            if (votes) {
                steps_.vote(before_vote, invalid, filtered, rows);
            } else {
                take_median(frame, scratch, filtered, rows);
            }
            if (!by_region) {
                finish(rows);
            }
        });
    }
    if (by_region) {
        const RegionTest test{invalid,          post.speckle_size, 16 * post.speckle_step,
                              post.min_texture, frame.left,        frame.right};
        steps_.speckle(filtered, test, scratch.work(frame.scratch), workers);
    }
    if (by_region || (post.median == 0 && !votes)) {
        parallel_rows(config_.height, workers, finish);
    }
}

namespace {

// Whether step 11 has enough to fill from. Mostly a few rows tell, which is quicker than to wake workers.
bool can_be_filled(Plane<const std::int16_t> disparity, std::int16_t invalid) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(disparity.width) * static_cast<std::uint64_t>(disparity.height);
    std::uint64_t measured = 0;
    for (int y = 0; y < disparity.height && !enough_to_fill_from(measured, pixels); ++y) {
        const std::int16_t* row = disparity.row(y);
        measured += static_cast<std::uint64_t>(disparity.width - std::count(row, row + disparity.width, invalid));
    }
    return enough_to_fill_from(measured, pixels);
}

}  // namespace

// Steps 11 and 12, and the depth of what they change. Confidence is finished before.
void FrameStages::fill(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const {
    const PostOptions& post = config_.options.post;
    const Plane<std::int16_t> filtered = scratch.filtered(frame);
    if (post.interpolate && can_be_filled(filtered, invalid_disparity(config_.options.range))) {
        steps_.interpolate(filtered, scratch.right_winner(frame.scratch), config_.options.range,
                           scratch.work(frame.scratch), workers);
    }
    if (post.guided_median > 0) {
        parallel_rows(config_.height, workers, [&](Rows rows) {
            steps_.guided_median(scratch.filtered(frame), frame.left, invalid_disparity(config_.options.range),
                                 post.guided_median, frame.disparity, rows);
            write_depth(steps_, config_.options.range, frame, rows);
        });
    } else if (post.interpolate) {
        parallel_rows(config_.height, workers,
                      [&](Rows rows) { write_depth(steps_, config_.options.range, frame, rows); });
    }
}

}  // namespace disparityd
