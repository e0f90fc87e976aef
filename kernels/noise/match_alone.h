// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/matcher.h"
#include "kernels/noise/noise_estimate.h"
#include "kernels/noise/noise_level.h"
#include "kernels/noise/noise_level_switch.h"

namespace disparityd {

/// Matches a pair that has no frame before it: match() is to match `frame` at frame.noise_level, which is 0 first.
/// Where `options` adapt to noise it is called again until the level that the pair's noise asks for stays, three times
/// more at most: a stream of such pairs would come to the same level.
template <typename Match>
void match_alone(const MatchOptions& options, FrameView& frame, const Match& match) {
    NoiseLevelSwitch levels;  // goes up only, as it sees so few results
    do {
        frame.noise_level = levels.level();
        match();
        if (adapts_to_noise(options)) {
            levels.add(estimate_noise(frame.left, frame.right, frame.disparity, frame.confidence));
        }
    } while (levels.level() != frame.noise_level);
}

}  // namespace disparityd
