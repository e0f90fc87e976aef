// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

/// Images of a frame as ROS 2 messages. Each returns nothing when the frame does not carry what it needs.
namespace disparityd::ros {

/// sensor_msgs/msg/Image: rgb8 when the frame carries the colours, else mono8.
std::optional<std::string> left_image(const disparity::Frame& frame, const FrameNames& names = {});
std::optional<std::string> right_image(const disparity::Frame& frame, const FrameNames& names = {});

/// sensor_msgs/msg/Image, mono8, whatever else the frame carries: nothing without the grey image.
std::optional<std::string> left_grey_image(const disparity::Frame& frame, const FrameNames& names = {});
std::optional<std::string> right_grey_image(const disparity::Frame& frame, const FrameNames& names = {});

/// sensor_msgs/msg/CompressedImage: the left image as JPEG, in colour where the frame carries it. `quality` is 1 ..
/// 100.
std::optional<std::string> left_jpeg(const disparity::Frame& frame, int quality, const FrameNames& names = {});

/// sensor_msgs/msg/Image, mono8: 0 is rejected or interpolated.
std::optional<std::string> confidence_image(const disparity::Frame& frame, const FrameNames& names = {});

/// sensor_msgs/msg/Image, 32FC1, m: NaN unknown, +infinity too far. From the depths that the daemon serves; from its
/// disparities where it serves none.
std::optional<std::string> depth_image(const disparity::Frame& frame, const FrameNames& names = {});

/// sensor_msgs/msg/Image, 16UC1, mm, as the daemon serves them: 0 unknown, 65535 beyond 65.534 m.
std::optional<std::string> depth_mm_image(const disparity::Frame& frame, const FrameNames& names = {});

/// sensor_msgs/msg/Image, 32FC1, m: one sigma of the depth, NaN unknown, +infinity 65.535 m or more.
std::optional<std::string> depth_error_image(const disparity::Frame& frame, const FrameNames& names = {});

/// stereo_msgs/msg/DisparityImage, 32FC1, px. The offset of the principal points is in the values, so that
/// Z = f t / d. A rejected pixel has min_disparity - 1, as the image pipeline of ROS has it.
std::optional<std::string> disparity_image(const disparity::Frame& frame, const FrameNames& names = {});

}  // namespace disparityd::ros
