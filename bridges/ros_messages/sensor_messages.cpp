// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/sensor_messages.h"

#include <array>

#include "bridges/ros_messages/message_header.h"

namespace disparityd::ros {
namespace {

using disparity::SensorSample;
using disparity::SensorVector;

constexpr std::array<double, 9> unknown_covariance{};
constexpr std::array<double, 9> not_measured{-1};

void write_vector(CdrWriter& cdr, const SensorVector& vector, double unit) {
    cdr.f64(vector.x * unit).f64(vector.y * unit).f64(vector.z * unit);
}

/// Temperature, pressure and humidity have the same fields: a number and its variance.
std::string scalar(const SensorSample& sample, std::string_view frame, double value) {
    CdrWriter cdr(64);
    write_header(cdr, sample.realtime_ns, frame);
    cdr.f64(value).f64(0);
    return cdr.take();
}

}  // namespace

std::optional<std::string> imu(const SensorSample& sample, const FrameNames& names) {
    if (!sample.inertial) {
        return std::nullopt;
    }
    CdrWriter cdr(384);
    write_header(cdr, sample.realtime_ns, names.imu);
    cdr.f64_array(std::array{0.0, 0.0, 0.0, 1.0}).f64_array(not_measured);
    write_vector(cdr, sample.inertial->angular_velocity, 1);
    cdr.f64_array(unknown_covariance);
    write_vector(cdr, sample.inertial->acceleration, 1);
    cdr.f64_array(unknown_covariance);
    return cdr.take();
}

std::optional<std::string> magnetic_field(const SensorSample& sample, const FrameNames& names) {
    if (!sample.magnetic_field) {
        return std::nullopt;
    }
    CdrWriter cdr(160);
    write_header(cdr, sample.realtime_ns, names.imu);
    write_vector(cdr, *sample.magnetic_field, 1e-6);
    cdr.f64_array(unknown_covariance);
    return cdr.take();
}

std::optional<std::string> imu_temperature(const SensorSample& sample, const FrameNames& names) {
    return sample.inertial ? std::optional(scalar(sample, names.imu, sample.inertial->celsius)) : std::nullopt;
}

std::optional<std::string> camera_temperature(const SensorSample& sample, const FrameNames& names) {
    return sample.environment ? std::optional(scalar(sample, names.camera, sample.environment->celsius)) : std::nullopt;
}

std::optional<std::string> left_temperature(const SensorSample& sample, const FrameNames& names) {
    const auto& eyes = sample.eye_temperatures;
    return eyes ? std::optional(scalar(sample, names.camera, eyes->left_celsius)) : std::nullopt;
}

std::optional<std::string> right_temperature(const SensorSample& sample, const FrameNames& names) {
    const auto& eyes = sample.eye_temperatures;
    return eyes ? std::optional(scalar(sample, names.camera, eyes->right_celsius)) : std::nullopt;
}

std::optional<std::string> pressure(const SensorSample& sample, const FrameNames& names) {
    const auto& air = sample.environment;
    return air ? std::optional(scalar(sample, names.camera, 100.0 * air->hectopascal)) : std::nullopt;
}

std::optional<std::string> humidity(const SensorSample& sample, const FrameNames& names) {
    const auto& air = sample.environment;
    return air ? std::optional(scalar(sample, names.camera, air->humidity_percent / 100.0)) : std::nullopt;
}

}  // namespace disparityd::ros
