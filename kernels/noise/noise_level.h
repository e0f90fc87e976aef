// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/anywhere.h"

namespace disparityd {

struct FrameView;
struct MatchOptions;

/// Noise levels are 0 .. 3, see docs/algorithm.md; at 0 a pair is matched as if it had none.
constexpr int last_noise_level = 3;

/// Step 9: the vote counts what differs by at most so much from the pixel, in 1/16 px, and wants a share of the window.
constexpr int vote_reach = 24;
constexpr int vote_percent = 52;

/// How much coarser than without noise a census is, 0 where there is none: by how much a neighbour must be darker, how
/// many rows apart rows are, and by how many bits gradients are shifted.
DISPARITYD_ANYWHERE constexpr int census_coarseness(int noise_level) {
    return noise_level < 2 ? noise_level : 2;
}

/// Returns whether there are noise levels: for SGM with census-7x5+gradient, four paths and adaptive P2.
bool supports_noise_levels(const MatchOptions& options);

/// Returns whether a matcher with these options takes the noise level of each frame.
bool adapts_to_noise(const MatchOptions& options);

/// Returns whether a matcher with these options can come to match at a level above 0.
bool has_noise_levels(const MatchOptions& options);

/// Returns the level at which a matcher with these options matches the frame; without levels 0.
int noise_level_of(const MatchOptions& options, const FrameView& frame);

/// Returns the options with what the level has in the place of theirs.
MatchOptions at_noise_level(const MatchOptions& options, int noise_level);

}  // namespace disparityd
