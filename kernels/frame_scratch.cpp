// SPDX-License-Identifier: Apache-2.0
#include "kernels/frame_scratch.h"

#include <algorithm>

#include "kernels/matcher.h"
#include "kernels/noise/noise_level.h"
#include "kernels/round_up_to_cache_line.h"
#include "kernels/steps.h"

namespace disparityd {

namespace {

std::size_t words_of_both(const MatcherConfig& config) {
    const std::size_t pixels = static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height);
    return config.options.method == Method::sad ? 0 : 2 * round_up_to_cache_line(pixels * sizeof(std::uint64_t));
}

template <typename T>
Plane<T> plane_at(std::span<std::byte> scratch, std::size_t offset, int width, int height) {
    return {reinterpret_cast<T*>(scratch.data() + offset), width, height, width};
}

}  // namespace

FrameScratch::FrameScratch(const FrameSteps& steps, const MatcherConfig& config)
    : FrameScratch(steps, config, words_of_both(config)) {}

FrameScratch::FrameScratch(const FrameSteps& steps, const MatcherConfig& config, std::size_t census_bytes)
    : width_(config.width),
      height_(config.height),
      matched_apart_((config.options.post.median > 0) != (config.options.post.guided_median > 0)),
      filtered_apart_(config.options.post.guided_median > 0) {
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    const PostOptions& post = config.options.post;
    right_winner_ = round_up_to_cache_line(pixels * sizeof(std::int16_t));
    apart_ = right_winner_ + round_up_to_cache_line(pixels * sizeof(std::int16_t));
    smoothed_left_ =
        apart_ + (matched_apart_ || filtered_apart_ ? round_up_to_cache_line(pixels * sizeof(std::int16_t)) : 0);
    const bool noisy = has_noise_levels(config.options);
    smoothed_right_ = smoothed_left_ + (noisy ? round_up_to_cache_line(pixels) : 0);
    shared_ = smoothed_right_ + (noisy ? round_up_to_cache_line(pixels) : 0);
    right_census_ = shared_ + round_up_to_cache_line(pixels * sizeof(std::uint64_t));
    bytes_ = shared_ + std::max({census_bytes, filters_regions(post) ? steps.speckle_scratch(width_, height_) : 0,
                                 post.interpolate ? steps.interpolate_scratch(width_, height_) : 0,
                                 noisy ? pixels * sizeof(std::int16_t) : 0});
}

Plane<std::int16_t> FrameScratch::left_winner(std::span<std::byte> scratch) const {
    return plane_at<std::int16_t>(scratch, 0, width_, height_);
}

Plane<std::int16_t> FrameScratch::right_winner(std::span<std::byte> scratch) const {
    return plane_at<std::int16_t>(scratch, right_winner_, width_, height_);
}

Plane<std::uint64_t> FrameScratch::left_census(std::span<std::byte> scratch) const {
    return plane_at<std::uint64_t>(scratch, shared_, width_, height_);
}

Plane<std::uint64_t> FrameScratch::right_census(std::span<std::byte> scratch) const {
    return plane_at<std::uint64_t>(scratch, right_census_, width_, height_);
}

Plane<std::uint8_t> FrameScratch::smoothed_left(std::span<std::byte> scratch) const {
    return plane_at<std::uint8_t>(scratch, smoothed_left_, width_, height_);
}

Plane<std::uint8_t> FrameScratch::smoothed_right(std::span<std::byte> scratch) const {
    return plane_at<std::uint8_t>(scratch, smoothed_right_, width_, height_);
}

Plane<std::int16_t> FrameScratch::before_vote(std::span<std::byte> scratch) const {
    return plane_at<std::int16_t>(scratch, shared_, width_, height_);
}

Plane<std::int16_t> FrameScratch::matched(const FrameView& frame) const {
    return matched_apart_ ? plane_at<std::int16_t>(frame.scratch, apart_, width_, height_) : frame.disparity;
}

Plane<std::int16_t> FrameScratch::filtered(const FrameView& frame) const {
    return filtered_apart_ ? plane_at<std::int16_t>(frame.scratch, apart_, width_, height_) : frame.disparity;
}

}  // namespace disparityd
