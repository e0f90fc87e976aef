// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/noise/noise_estimate.h"

namespace disparityd {

/// Chooses the noise level of the next frame from the noise of the frames before it. It goes up at once, and down when
/// a row of frames has had clearly less noise: a picture at a limit does not go up and down. The same estimates give
/// the same levels. One thread at a time.
class NoiseLevelSwitch {
public:
    /// Of the frame to come, 0 .. 3 (MatchOptions::noise_level).
    int level() const { return level_; }

    /// Takes the estimate of a frame that was matched with level(). One of too few blocks tells nothing: the level
    /// stays.
    void add(const NoiseEstimate& estimate);

    /// Begins anew with level 0, as at a discontinuity: the next frame has nothing to do with the one before.
    void restart() { *this = {}; }

private:
    int level_ = 0;
    int calm_frames_ = 0;  // how many in a row asked for a lower level
};

}  // namespace disparityd
