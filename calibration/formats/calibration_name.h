// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// What a user gives as a calibration: "stereo.yml", "left.yaml,right.yaml", "left.yaml,right.yaml,imu.yaml", and
/// behind it what the files leave open, as in "stereo.yml?unit=m&model=brown".
struct CalibrationName {
    std::vector<std::string> files;  ///< one to three
    std::optional<double> unit_mm;   ///< unit=mm, cm, m or the side of the board's squares, as 25mm
    std::optional<LensModel> lens;   ///< model=brown, fisheye: of four coefficients, where the file names no model
    std::optional<KittiPair> pair;   ///< pair=grey, pair=colour
};

/// Files that exist are preferred where a name holds commas or a question mark. Throws std::invalid_argument with one
/// line when what stands behind the question mark is not known.
CalibrationName parse_calibration_name(const std::string& name);

/// Returns the millimetres of a unit: mm, cm, m, their English names, or a length such as "25mm"; nothing for others.
std::optional<double> millimetres_of_unit(std::string_view unit);

}  // namespace disparityd::calibration
