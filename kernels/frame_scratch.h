// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/image.h"

namespace disparityd {

struct FrameView;
struct FrameSteps;
struct MatcherConfig;

/// How a frame's scratch is divided: what travels with a frame from one stage to the next.
class FrameScratch {
public:
    FrameScratch(const FrameSteps& steps, const MatcherConfig& config);
    /// With room for a census of another form than two planes of words.
    FrameScratch(const FrameSteps& steps, const MatcherConfig& config, std::size_t census_bytes);

    std::size_t bytes() const { return bytes_; }

    Plane<std::int16_t> left_winner(std::span<std::byte> scratch) const;
    Plane<std::int16_t> right_winner(std::span<std::byte> scratch) const;

    /// Where matching leaves its disparities: in the frame's plane, or in one of the scratch. Each median reads one of
    /// the two and writes the other; the last one writes the frame's.
    Plane<std::int16_t> matched(const FrameView& frame) const;

    /// Where the disparities are after the median of step 9.
    Plane<std::int16_t> filtered(const FrameView& frame) const;

    /// From census to match.
    Plane<std::uint64_t> left_census(std::span<std::byte> scratch) const;
    Plane<std::uint64_t> right_census(std::span<std::byte> scratch) const;

    std::span<std::byte> census(std::span<std::byte> scratch) const { return scratch.subspan(shared_); }

    /// Both images smoothed, from census to match: where there may be noise levels above 0.
    Plane<std::uint8_t> smoothed_left(std::span<std::byte> scratch) const;
    Plane<std::uint8_t> smoothed_right(std::span<std::byte> scratch) const;

    /// Disparities before the vote of step 9, in the place of the census words.
    Plane<std::int16_t> before_vote(std::span<std::byte> scratch) const;

    /// During post-processing, in the place of the census words.
    std::span<std::byte> work(std::span<std::byte> scratch) const { return scratch.subspan(shared_); }

private:
    int width_;
    int height_;
    bool matched_apart_;        // not in the frame's plane
    bool filtered_apart_;       // likewise
    std::size_t right_winner_;  // offsets
    std::size_t apart_;
    std::size_t smoothed_left_;
    std::size_t smoothed_right_;
    std::size_t shared_;
    std::size_t right_census_;
    std::size_t bytes_;
};

}  // namespace disparityd
