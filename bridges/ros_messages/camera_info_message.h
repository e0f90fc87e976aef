// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

enum class Camera { left, right };

/// Returns a sensor_msgs/msg/CameraInfo of a rectified camera; nothing for a frame without a calibration. Both refer to
/// the left camera's frame: the right one's P maps points of that frame, with P[3] = -f B in px m.
std::optional<std::string> camera_info(const disparity::Frame& frame, Camera camera, const FrameNames& names = {});

}  // namespace disparityd::ros
