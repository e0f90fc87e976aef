// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>

#include "disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparity {

namespace v1 = disparityd::v1;

namespace {

std::optional<InertialPose> pose_of(const v1::InertialPose& message) {
    InertialPose pose;
    if (message.rotation_size() != static_cast<int>(pose.rotation.size()) ||
        message.translation_mm_size() != static_cast<int>(pose.translation_mm.size())) {
        return std::nullopt;
    }
    std::copy(message.rotation().begin(), message.rotation().end(), pose.rotation.begin());
    std::copy(message.translation_mm().begin(), message.translation_mm().end(), pose.translation_mm.begin());
    return pose;
}

std::optional<double> known(double noise) {
    return noise > 0 ? std::optional(noise) : std::nullopt;
}

}  // namespace

std::optional<InertialCalibration> inertial_calibration(const std::string& status) {
    v1::Status message;
    if (!message.ParseFromString(status)) {
        throw std::invalid_argument("found " + std::to_string(status.size()) +
                                    " bytes that are no status, expected what status() has returned");
    }
    if (!message.has_inertial_calibration()) {
        return std::nullopt;
    }
    const v1::InertialCalibration& from = message.inertial_calibration();
    InertialCalibration calibration;
    calibration.calibration_id = message.geometry().calibration_id();
    calibration.pose = from.has_pose() ? pose_of(from.pose()) : std::nullopt;
    if (from.has_time_offset()) {
        calibration.time_offset_s = from.time_offset().seconds();
    }
    calibration.gyroscope_noise_density = known(from.gyroscope_noise_density());
    calibration.gyroscope_random_walk = known(from.gyroscope_random_walk());
    calibration.accelerometer_noise_density = known(from.accelerometer_noise_density());
    calibration.accelerometer_random_walk = known(from.accelerometer_random_walk());
    return calibration;
}

}  // namespace disparity
