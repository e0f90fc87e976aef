// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/anywhere.h"

namespace disparityd {

// The evidence of texture of step 10 in docs/algorithm.md, in one place for every back end. C++17: the CUDA compiler
// reads this.

/// A pixel has texture from this horizontal gradient on (Sobel's operator, not clamped), and when the gradient differs
/// by as much from that of a ramp through the pixels `texture_reach` to its left and right.
constexpr int texture_gradient = 12;
constexpr int texture_reach = 8;

/// A region needs so many votes whatever its share is: below that, noise agrees by chance.
constexpr int texture_votes = 48;

/// Returns what a pixel says of its match: 1 where it has texture and the other eye confirms it, -1 where the other eye
/// refutes it, 0 without texture. `gradient` is the left image's at the pixel, `ramp` the difference over
/// `texture_reach` to both sides, `other` and `next` the right image's gradients at the two pixels between which the
/// match lies: what is between them agrees.
DISPARITYD_ANYWHERE constexpr int texture_vote(int gradient, int ramp, int other, int next) {
    const int steep = gradient < 0 ? -gradient : gradient;
    const int bend = texture_reach * gradient - ramp;
    if (steep < texture_gradient || (bend < 0 ? -bend : bend) < texture_reach * texture_gradient) {
        return 0;
    }
    const int least = other < next ? other : next;
    const int most = other < next ? next : other;
    const int apart = gradient < least ? least - gradient : gradient > most ? gradient - most : 0;
    return 2 * apart <= steep ? 1 : -1;
}

/// Returns whether the votes of a region of so many pixels are enough; `percent` is the option min_texture, above 0.
DISPARITYD_ANYWHERE constexpr bool has_texture(int votes, int pixels, int percent) {
    return votes >= texture_votes && std::int64_t{100} * votes >= std::int64_t{percent} * pixels;
}

}  // namespace disparityd
