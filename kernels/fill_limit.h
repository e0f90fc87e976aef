// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/anywhere.h"

namespace disparityd {

// When step 11 of docs/algorithm.md has enough to fill from, in one place for every back end. C++17: the CUDA compiler
// reads this.

/// One pixel of so many must be measured.
constexpr int pixels_for_one_measured = 20;

/// Returns whether step 11 fills an image of so many pixels, of which `measured` are not rejected.
DISPARITYD_ANYWHERE constexpr bool enough_to_fill_from(std::uint64_t measured, std::uint64_t pixels) {
    return measured * pixels_for_one_measured >= pixels;
}

}  // namespace disparityd
