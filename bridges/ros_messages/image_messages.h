// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

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

/// An image that is no product of a frame: rows as a camera gave them. It belongs to somebody else.
struct ImageRows {
    std::uint32_t width = 0;    ///< px
    std::uint32_t height = 0;   ///< px
    std::string_view encoding;  ///< as sensor_msgs/msg/Image has it, of whole bytes: "mono8", "bgr8", "yuv422_yuy2"
    std::uint32_t bytes_per_pixel = 1;
    const std::uint8_t* data = nullptr;
    std::ptrdiff_t stride = 0;  ///< bytes from one row to the next
};

/// sensor_msgs/msg/Image of the rows, without gaps between them. `realtime_ns` is counted from 1970.
std::string rows_image(const ImageRows& rows, std::int64_t realtime_ns, std::string_view frame);

}  // namespace disparityd::ros
