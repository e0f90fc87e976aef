// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "calibration/calibration.h"

namespace disparityd::empty_result {

/// How much larger, in both directions, the pictures were that a calibration was made of than the frames that it is
/// used for, as its principal points tell: cameras have them near the middle. Nothing where it fits, or where the
/// principal points say nothing.
std::optional<double> size_of_calibration(const calibration::StereoCalibration& calibration);

}  // namespace disparityd::empty_result
