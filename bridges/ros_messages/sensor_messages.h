// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

/// What the camera's sensors measured, as ROS 2 messages. Each returns nothing when the sample does not have it.
/// Covariances and variances are 0: nobody knows them.
namespace disparityd::ros {

/// sensor_msgs/msg/Imu: rad/s and m/s², gravity included. The first number of the orientation's covariance is -1:
/// the orientation is not measured.
std::optional<std::string> imu(const disparity::SensorSample& sample, const FrameNames& names = {});

/// sensor_msgs/msg/MagneticField, in tesla.
std::optional<std::string> magnetic_field(const disparity::SensorSample& sample, const FrameNames& names = {});

/// sensor_msgs/msg/Temperature, in degrees Celsius: of the inertial sensor, inside the camera, of the image sensors.
std::optional<std::string> imu_temperature(const disparity::SensorSample& sample, const FrameNames& names = {});
std::optional<std::string> camera_temperature(const disparity::SensorSample& sample, const FrameNames& names = {});
std::optional<std::string> left_temperature(const disparity::SensorSample& sample, const FrameNames& names = {});
std::optional<std::string> right_temperature(const disparity::SensorSample& sample, const FrameNames& names = {});

/// sensor_msgs/msg/FluidPressure, in pascal.
std::optional<std::string> pressure(const disparity::SensorSample& sample, const FrameNames& names = {});

/// sensor_msgs/msg/RelativeHumidity, 0 .. 1.
std::optional<std::string> humidity(const disparity::SensorSample& sample, const FrameNames& names = {});

}  // namespace disparityd::ros
