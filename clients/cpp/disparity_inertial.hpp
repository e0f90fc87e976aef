// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a daemon's calibration knows about the inertial sensor; disparity_client.hpp includes it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// Marks what the library exports.
#define DISPARITY_API __attribute__((visibility("default")))

namespace disparity {

/// Where the inertial sensor stands: takes points of its axes, which SensorSample::inertial has, to those of the
/// rectified left camera, which Point has: p_camera = rotation p_sensor + translation_mm. It is Kalibr's T_cam_imu,
/// turned as the left image was rectified: the axes of a measured vector are turned by the rotation alone.
struct InertialPose {
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
    std::array<double, 3> translation_mm{};                     ///< of the sensor's origin, in the camera's axes
};

/// What the calibration knows about the inertial sensor; what is absent is not known. The numbers have the names, signs
/// and units of Kalibr.
struct InertialCalibration {
    /// Of the frames that the pose holds for, FrameInfo::calibration_id: self-calibration turns the rectified camera.
    std::uint64_t calibration_id = 0;
    std::optional<InertialPose> pose;  ///< where the sensor stands
    /// s; what a frame of the time t shows stands in the samples at t + this, with monotonic_ns of both.
    std::optional<double> time_offset_s;
    std::optional<double> gyroscope_noise_density;      ///< white noise, rad/s/sqrt(Hz)
    std::optional<double> gyroscope_random_walk;        ///< of the bias, rad/s²/sqrt(Hz)
    std::optional<double> accelerometer_noise_density;  ///< white noise, m/s²/sqrt(Hz)
    std::optional<double> accelerometer_random_walk;    ///< of the bias, m/s³/sqrt(Hz)
};

/// Reads it from a status, as SocketClient::status() and Client::status() return it. Nothing where the calibration
/// knows nothing of an inertial sensor. Throws std::invalid_argument for bytes that are no status. Any thread.
DISPARITY_API std::optional<InertialCalibration> inertial_calibration(const std::string& status);

}  // namespace disparity
