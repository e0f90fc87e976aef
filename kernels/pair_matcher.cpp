// SPDX-License-Identifier: Apache-2.0
#include "kernels/pair_matcher.h"

#include <stdexcept>
#include <string>

#include "kernels/noise/match_alone.h"

namespace disparityd {

namespace {

std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

template <typename T>
void check_size(const std::string& name, const Plane<T>& plane, const MatcherConfig& config) {
    if (plane && plane.width == config.width && plane.height == config.height && plane.stride >= plane.width) {
        return;
    }
    const std::string found =
        plane ? size_text(plane.width, plane.height) + " with rows " + std::to_string(plane.stride) + " apart"
              : "missing";
    throw std::invalid_argument(name + " plane is " + found + ": this matcher is made for " +
                                size_text(config.width, config.height));
}

template <typename T>
void check_optional(const std::string& name, const Plane<T>& plane, const MatcherConfig& config) {
    if (plane) {
        check_size(name, plane, config);
    }
}

// The stages after the first, which are all that run here, only read the pair.
Plane<std::uint8_t> as_frame_has_it(Plane<const std::uint8_t> image) {
    return {const_cast<std::uint8_t*>(image.data), image.width, image.height, image.stride};
}

}  // namespace

PairMatcher::PairMatcher(int width, int height, const MatchOptions& options, std::string_view back_end)
    : matcher_(make_matcher(back_end, {width, height, options})),
      scratch_(matcher_->scratch_bytes()),
      confidence_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void PairMatcher::match(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const PairResults& results,
                        Parallel& workers) {
    const MatcherConfig& size = config();
    check_size("left", left, size);
    check_size("right", right, size);
    check_size("disparity", results.disparity, size);
    check_optional("confidence", results.confidence, size);
    check_optional("depth", results.depth, size);
    FrameView frame;
    frame.left = as_frame_has_it(left);
    frame.right = as_frame_has_it(right);
    frame.disparity = results.disparity;
    frame.confidence = results.confidence;
    if (!frame.confidence) {
        frame.confidence = {reinterpret_cast<std::uint8_t*>(confidence_.data()), size.width, size.height, size.width};
    }
    frame.depth = results.depth;
    frame.depth_scale = results.depth_scale;
    frame.scratch = {scratch_.data(), scratch_.size()};
    match_alone(size.options, frame, [&] { match_pair(*matcher_, frame, workers); });
}

}  // namespace disparityd
