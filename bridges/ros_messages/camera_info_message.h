// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/ros_messages/frame_names.h"
#include "bridges/ros_messages/message_header.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

enum class Camera { left, right };

/// Returns a sensor_msgs/msg/CameraInfo of a rectified camera; nothing for a frame without a calibration. Both refer to
/// the left camera's frame: the right one's P maps points of that frame, with P[3] = -f B in px m.
std::optional<std::string> camera_info(const disparity::Frame& frame, Camera camera, const FrameNames& names = {});

/// What a CameraInfo says, under its names. The default lens has no distortion.
struct CameraInfoFields {
    std::int64_t realtime_ns = 0;  ///< counted from 1970
    std::string frame;
    std::uint32_t width = 0;  ///< px, as height: of the whole image
    std::uint32_t height = 0;
    std::string model = "plumb_bob";                     ///< or "rational_polynomial", "equidistant"
    std::vector<double> d = std::vector<double>(5);      ///< the lens's coefficients, as many as the model has
    std::array<double, 9> k{};                           ///< the lens's camera matrix, row by row
    std::array<double, 9> r{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< turns the axes of the lens to the rectified ones
    std::array<double, 12> p{};                          ///< of the rectified camera, 3x4, row by row
    Region region = {};
};

/// Returns how ROS calls the model of a lens: of a fisheye, or of one with so many coefficients.
std::string_view distortion_model(bool fisheye, std::size_t coefficients);

/// Returns the P of a rectified camera; `shift` is P[3], px m, as all others are px.
std::array<double, 12> projection(double f, double cx, double cy, double shift);

/// The same of a frame that has a calibration.
std::array<double, 12> projection(const disparity::Frame& frame, Camera camera);

/// Returns the sensor_msgs/msg/CameraInfo of these fields: also of a camera that is not rectified.
std::string camera_info_message(const CameraInfoFields& fields);

}  // namespace disparityd::ros
