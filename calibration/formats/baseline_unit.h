// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

/// Multiplies the translations: that of the right camera and that of the inertial sensor.
void scale_lengths(StereoCalibration& calibration, double factor);

/// Returns the calibration with its translations in mm. `wanted_mm` is the unit that the user names for the file, in
/// mm. Where neither the user nor the file names one, a baseline under 20 mm or over 2 m is refused, as most such files
/// are in another unit than the format's: std::invalid_argument with one line that names the units. `name` is how the
/// user calls the calibration.
StereoCalibration settle_unit(FileCalibration read, std::optional<double> wanted_mm, const std::string& name);

}  // namespace disparityd::calibration
