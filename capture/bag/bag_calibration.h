// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "formats/ros_message.h"

namespace disparityd::capture {

/// A sensor_msgs/msg/CameraInfo with the part of the sensor and the binning applied: for the images as they are.
struct BagCameraInfo {
    std::string topic;  ///< for messages: file and topic
    int width = 0;      ///< px
    int height = 0;
    std::string model;
    std::vector<double> distortion;
    std::vector<double> camera;      ///< 3x3, row by row; all 0: the camera is not calibrated
    std::vector<double> rotation;    ///< 3x3
    std::vector<double> projection;  ///< 3x4
};

/// Throws std::runtime_error with one line where the message has other fields; it does not say which message it is.
BagCameraInfo camera_info_of(const formats::RosMessage& message, const std::string& topic);

/// Returns the calibration of raw images, or, where `rectified`, that of images that ROS has rectified: from the
/// projections alone. Nothing where the cameras are not calibrated. Throws std::invalid_argument with one line for what
/// cannot be used: a lens that is not rectified, another size than the images', numbers that no camera has.
std::optional<calibration::StereoCalibration> calibration_of(const BagCameraInfo& left, const BagCameraInfo& right,
                                                             int width, int height, bool rectified);

}  // namespace disparityd::capture
