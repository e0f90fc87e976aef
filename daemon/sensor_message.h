// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "calibration/inertial_calibration.h"
#include "capture/sensor_sample.h"
#include "capture/source_condition.h"
#include "proto/disparity.pb.h"

/// The camera's sensors as messages of the protocol.
namespace disparityd::daemon {

void fill_message(const capture::SensorSample& sample, v1::SensorSample& message);
v1::SensorStatus to_message(const capture::SensorFacts& sensors);

/// `to_rectified` leads from the left camera that the calibration describes to the rectified one
/// (Rectification::left_rotation). `moved_us`: by how much the frames' stamps were moved (SourceInfo::time_offset_us),
/// which the time offset of the message no longer contains.
v1::InertialCalibration to_message(const calibration::InertialCalibration& inertial,
                                   const std::array<double, 9>& to_rectified, int moved_us);

}  // namespace disparityd::daemon
