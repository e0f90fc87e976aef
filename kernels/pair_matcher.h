// SPDX-License-Identifier: Apache-2.0
/// @file
/// The matcher as a library: rectified pair in, disparity out.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "kernels/large_buffer.h"
#include "kernels/matcher.h"

namespace disparityd {

/// Where the results of a pair go: planes of the caller, of the pair's size.
struct PairResults {
    Plane<std::int16_t> disparity;   ///< 1/16 px; rejected = invalid_disparity(options.range)
    Plane<std::uint8_t> confidence;  ///< 1 to 255; 0 = rejected or interpolated; optional
    Plane<std::uint16_t> depth;      ///< mm; 0 = unknown, 65535 = valid but farther than 65.534 m; optional
    DepthScale depth_scale;          ///< what depth is computed with
};

/// Matches rectified pairs of one size: two grey images in, planes out, for programs that have such pairs already and
/// need neither camera nor daemon. All memory but the caller's planes is allocated by the constructor.
///
/// One call at a time for an object; different objects are independent.
class PairMatcher {
public:
    /// Allocates what matching needs. `width` and `height`: 1 to 8192 each. `back_end`: a name of backends(), or "auto"
    /// for the fastest that this machine can run: one that is on a GPU which has no memory left, or is lost later,
    /// gives way to the next, and trouble() says so. Throws std::invalid_argument with one line for people when an
    /// argument is not allowed, std::runtime_error when the memory is missing.
    PairMatcher(int width, int height, const MatchOptions& options, std::string_view back_end = "auto");

    /// With adaptive_noise a noisy pair is matched again, until its noise level stays: three times more at most.
    /// Left pixel (x, y) and right pixel (x - disparity, y) show the same; the images are read only. `workers`: Serial
    /// for the calling thread alone, or an own Parallel around the program's threads; results do not depend on it.
    /// Throws std::invalid_argument when a plane has another size, std::runtime_error when a back end chosen by name
    /// loses its device, or when there is no memory for the one that takes its place.
    void match(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const PairResults& results,
               Parallel& workers);

    /// What it was made with: size and options.
    const MatcherConfig& config() const { return matcher_->config(); }

    /// One line on what went wrong and was made good; empty as long as all is well. From any thread.
    std::string trouble() const { return matcher_->trouble(); }

private:
    std::unique_ptr<Matcher> matcher_;
    LargeBuffer scratch_;
    LargeBuffer confidence_;  // where the caller wants none
};

}  // namespace disparityd
