// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_level_switch.h"

#include <array>

namespace disparityd {

namespace {

// Levels 1, 2 and 3 begin at 1.75, 2.2 and 3.2 grey levels.
constexpr std::array begins_at = {448, 563, 819};

// Below seven eighths of where it began a level is no longer needed.
constexpr int eighths_to_stay = 7;
constexpr int calm_frames_to_go_down = 10;
constexpr int least_blocks = 8;

// With `eighths` of the limits.
int level_for(int sigma256, int eighths) {
    int level = 0;
    for (const int limit : begins_at) {
        level += 8 * sigma256 >= eighths * limit ? 1 : 0;
    }
    return level;
}

}  // namespace

void NoiseLevelSwitch::add(const NoiseEstimate& estimate) {
    if (estimate.blocks < least_blocks) {
        return;
    }
    const int highest = level_for(estimate.sigma256, eighths_to_stay);
    calm_frames_ = highest < level_ ? calm_frames_ + 1 : 0;
    if (const int needed = level_for(estimate.sigma256, 8); needed > level_) {
        level_ = needed;
    } else if (calm_frames_ == calm_frames_to_go_down) {
        level_ = highest;
        calm_frames_ = 0;
    }
}

}  // namespace disparityd
