// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "calibration/calibration.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// How both eyes were turned to be rectified, row by row: Rectification::left_rotation and right_rotation.
struct Turns {
    std::array<double, 9> left;
    std::array<double, 9> right;
};

/// Returns what the calibration says of the eyes as they capture; nothing for one of images that are rectified already.
std::optional<v1::RawCameras> raw_cameras(const calibration::StereoCalibration& calibration, const Turns& turns);

}  // namespace disparityd::daemon
