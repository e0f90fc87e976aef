// SPDX-License-Identifier: Apache-2.0
#include "kernels/frame_stages.h"

#include <algorithm>
#include <stdexcept>
#include <string>

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

void FrameStages::rectify(const FrameView& frame, Parallel& workers) const {
    check_fits(frame);
    parallel_rows(config_.height, workers, [&](Rows rows) {
        steps_.rectify(frame.raw, Eye::left, *frame.rectifier, frame.left, rows);
        steps_.rectify(frame.raw, Eye::right, *frame.rectifier, frame.right, rows);
        if (frame.left_colour) {
            steps_.rectify_colour(frame.raw, *frame.rectifier, frame.left_colour, rows);
        }
    });
}

void FrameStages::post_process(const FrameView& frame, const FrameScratch& scratch, Parallel& workers) const {
    const int height = config_.height;
    const MatchOptions& options = config_.options;
    const PostOptions& post = options.post;
    const std::int16_t invalid = invalid_disparity(options.range);
    const Plane<std::int16_t> matched = scratch.matched(frame);
    if (post.left_right_check) {
        parallel_rows(height, workers, [&](Rows rows) {
            steps_.left_right(scratch.left_winner(frame.scratch), scratch.right_winner(frame.scratch), options.range,
                              matched, rows);
        });
    }
    const auto write_depth = [&](Rows rows) {
        if (frame.depth) {
            steps_.depth(frame.disparity, invalid, frame.depth_scale, frame.depth, rows);
        }
    };
    const auto finish = [&](Rows rows) {
        steps_.mask_confidence(frame.disparity, invalid, frame.confidence, rows);
        if (!post.interpolate) {
            write_depth(rows);
        }
    };
    const bool despeckle = post.speckle_size > 0;
    if (post.median > 0) {
        parallel_rows(height, workers, [&](Rows rows) {
            steps_.median(matched, invalid, post.median, frame.disparity, rows);
            if (!despeckle) {
                finish(rows);  // each time that workers are woken takes as long as many rows
            }
        });
    }
    if (despeckle) {
        steps_.speckle(frame.disparity, invalid, post.speckle_size, 16 * post.speckle_step, scratch.work(frame.scratch),
                       workers);
    }
    if (post.median == 0 || despeckle) {
        parallel_rows(height, workers, finish);
    }
    if (post.interpolate) {
        steps_.interpolate(frame.disparity, scratch.right_winner(frame.scratch), options.range,
                           scratch.work(frame.scratch), workers);
        parallel_rows(height, workers, write_depth);
    }
}

}  // namespace disparityd
