// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "bridges/ros_messages/camera_info_message.h"
#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

/// The eyes as they capture, before rectification.
namespace disparityd::ros {

/// What the daemon's status says of the lenses.
struct RawCalibration {
    std::uint64_t calibration_id = 0;  ///< of the frames for which it holds
    v1::RawCameras cameras = {};
};

/// Returns it, or nothing where nothing is known of them.
std::optional<RawCalibration> raw_calibration(const v1::Status& status);

/// Returns how the left eye is turned to be rectified, row by row.
std::optional<std::array<double, 9>> left_turn(const RawCalibration& raw);

/// sensor_msgs/msg/Image, mono8, in the frame of reference `names.raw`; nothing when the frame does not carry it.
std::optional<std::string> raw_image(const disparity::Frame& frame, Camera camera, const FrameNames& names);

/// sensor_msgs/msg/CameraInfo of an eye as it captures: K and D are the lens's, R turns it to the rectified camera, of
/// which P is the projection. Both eyes have the frame of reference `names.raw`. Nothing when `raw` is of another
/// calibration than the frame.
std::optional<std::string> raw_camera_info(const disparity::Frame& frame, const RawCalibration& raw, Camera camera,
                                           const FrameNames& names);

}  // namespace disparityd::ros
