// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::calibration {

enum class CalibrationFormat { factory, opencv, ros, orbslam, kalibr, euroc, middlebury, kitti, inertial };

/// Tells the format of a calibration by its content. Throws std::invalid_argument with one line that lists the formats
/// when it is none of them, or names the format when it is known and cannot be read.
CalibrationFormat calibration_format(const std::string& path, const std::string& text);

/// Returns the name of the format for messages, such as "a factory .conf".
std::string format_name(CalibrationFormat format);

}  // namespace disparityd::calibration
