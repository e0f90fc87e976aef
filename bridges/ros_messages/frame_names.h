// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::ros {

/// The frames of reference that messages name. The defaults are those of the one camera that a viewer looks at.
struct FrameNames {
    /// The rectified left camera, an optical frame: x right, y down, z ahead. Both cameras' information and images
    /// refer to it, as the image pipeline of ROS asks for.
    std::string left = "left_camera";
    /// The left camera as it captures, before it is turned to be rectified: also an optical frame, at the same place.
    std::string raw = "left_camera_raw";
    /// The same place with the robot's axes: x ahead, y left, z up. Viewers draw z upwards.
    std::string camera = "camera";
    /// The frame of obstacle scans: on the ground below the camera, or where the daemon's configuration has its origin.
    std::string scan = "camera_footprint";
    /// The axes of the inertial sensor.
    std::string imu = "camera_imu";
};

}  // namespace disparityd::ros
