// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::calibration {

/// Takes points of one frame of axes to another: p_to = rotation p_from + translation.
struct Pose {
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
    std::array<double, 3> translation{};                        ///< mm

    bool operator==(const Pose&) const = default;
};

/// Returns the pose of the upper three rows of a 4x4 matrix, row by row.
Pose pose_of_rows(std::span<const double> rows);

/// Returns the pose that leads back.
Pose inverse(const Pose& pose);

/// Returns the pose that leads where `second` leads from where `first` has led.
Pose chained(const Pose& first, const Pose& second);

/// What is known about the inertial sensor (IMU) beside the cameras. Nothing: not known. Names, signs and units are
/// those of Kalibr (its wiki, "Yaml formats" and "IMU noise model"), which EuRoC's sensor.yaml shares for the noise.
struct InertialCalibration {
    /// Kalibr's T_cam_imu of the left camera: takes points of the sensor's axes to those of the left camera, as
    /// StereoCalibration describes it. That is the camera that took raw images, and the rectified one only where
    /// StereoCalibration::rectified says so; Rectification::left_rotation leads from it to the rectified one.
    std::optional<Pose> to_left_camera;
    /// Kalibr's timeshift_cam_imu, s: what happens in a frame of the time t stands in the samples at t + this.
    std::optional<double> time_offset_s;
    std::optional<double> gyroscope_noise_density;      ///< white noise, rad/s/sqrt(Hz), above 0
    std::optional<double> gyroscope_random_walk;        ///< of the bias, rad/s²/sqrt(Hz), above 0
    std::optional<double> accelerometer_noise_density;  ///< white noise, m/s²/sqrt(Hz), above 0
    std::optional<double> accelerometer_random_walk;    ///< of the bias, m/s³/sqrt(Hz), above 0

    bool operator==(const InertialCalibration&) const = default;

    /// Returns whether anything is known.
    bool is_known() const { return *this != InertialCalibration(); }
};

/// A number of InertialCalibration, under the name that Kalibr gives it.
struct InertialNumber {
    std::string_view key;
    std::optional<double> InertialCalibration::*member;
};

inline constexpr std::array inertial_numbers{
    InertialNumber{"timeshift_cam_imu", &InertialCalibration::time_offset_s},
    InertialNumber{"gyroscope_noise_density", &InertialCalibration::gyroscope_noise_density},
    InertialNumber{"gyroscope_random_walk", &InertialCalibration::gyroscope_random_walk},
    InertialNumber{"accelerometer_noise_density", &InertialCalibration::accelerometer_noise_density},
    InertialNumber{"accelerometer_random_walk", &InertialCalibration::accelerometer_random_walk},
};

/// Throws std::invalid_argument with one line ("calibration PATH: ...") for what no sensor can have: a matrix that is
/// no rotation, a distance beyond 100 m, an offset beyond 60 s, noise that is not above 0.
void check_inertial(const InertialCalibration& inertial, const std::string& path);

}  // namespace disparityd::calibration
