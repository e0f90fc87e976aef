// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "kernels/added_stage.h"
#include "obstacles/given_levels.h"
#include "obstacles/scan.h"
#include "obstacles/scan_options.h"

namespace disparityd::scan {

/// Where the axes of an inertial sensor point, along the camera's: of each, x first, the part to the right, down and
/// ahead. Each of the three is one of the camera's axes, forwards or backwards.
struct SensorAxes {
    std::array<CameraDirection, 3> of;

    /// Returns a direction along the sensor's axes as one along the camera's, with length 1.
    CameraDirection turned(const SensorDirection& direction) const;
};

/// What parse_sensor_axes() takes, for a message.
inline constexpr std::string_view sensor_axes_form =
    "where the sensor's x, y and z axes point, three of right, left, up, down, ahead and back, such as "
    "\"ahead left up\"";

/// Reads three words with one space between them, one for each axis of the sensor. Returns nothing for other words, for
/// two that lie along the same line, and for axes that are no right-handed system: no sensor has those.
std::optional<SensorAxes> parse_sensor_axes(std::string_view text);

/// Returns a direction along the robot's axes as one along the camera's.
CameraDirection along_camera(const RobotUp& up, const ScanOptions& options);

/// A camera that is tilted further from its mounting than this has fallen over, or its axes are configured wrongly:
/// 30 degrees, as the least cosine.
inline constexpr double least_upright = 0.866;

/// Returns the level plane that lies the camera's height below it. `up`: where up is, away from gravity. Returns
/// nothing when the robot's up axis is more than 30 degrees away from that.
std::optional<GroundPlane> level_ground(const CameraDirection& up, const ScanOptions& options);

}  // namespace disparityd::scan
