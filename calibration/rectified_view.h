// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// Checks that two raw eyes can be rectified to a camera that is like them: its focal length is within a quarter and
/// four times theirs, it shows at least a quarter of each eye's image, and the lenses do not fold what it shows.
/// Numbers may each be possible and together be those of no camera. Throws std::invalid_argument with one line.
void check_rectified_view(const StereoCalibration& calibration);

}  // namespace disparityd::calibration
