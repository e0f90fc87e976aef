// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/bag/bag_calibration.h"
#include "capture/bag/bag_topics.h"

namespace disparityd::capture {

/// What a bag says about its cameras and its inertial sensor.
struct BagSurvey {
    std::optional<BagCameraInfo> left;  ///< the first CameraInfo of each eye
    std::optional<BagCameraInfo> right;
    std::optional<calibration::Pose> imu_to_left;  ///< from the sensor's frame to that of the left images
};

/// Reads a bag until all is known, at most `most_bytes` of it, and at most 16 MiB for the transforms alone. Throws as
/// BagMessages.
BagSurvey survey_bag(const std::string& path, const ChosenTopics& topics, std::uint64_t most_bytes);

}  // namespace disparityd::capture
