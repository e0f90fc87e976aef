// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "calibration/empty_result/empty_result.h"
#include "tests/tools/made_causes.h"

namespace disparityd::empty_result {

Plane<const std::uint8_t> view(const cv::Mat& image);

/// What makes a result nearly empty, and what the note must say of it.
struct Kind {
    test::RenderedPair (*make)(unsigned seed);
    const char* words;
};

inline constexpr std::array<Kind, 5> kinds{{{test::exchanged_pair, "left and right are exchanged"},
                                            {test::near_pair, "the range of disparities is too small"},
                                            {test::unaligned_pair, "the rows of the two images are not aligned"},
                                            {test::plain_pair, " no texture"},
                                            {test::other_resolution_pair, "is of another resolution"}}};

/// Of how many seeds the note names the right cause; each preset in turn.
int rightly_named(const Kind& kind, unsigned first, unsigned count);

/// Expects that nothing is told of good pairs, whatever the method and the preset.
void expect_nothing_told_of_good_pairs(unsigned first, unsigned count);

}  // namespace disparityd::empty_result
