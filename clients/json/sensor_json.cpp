// SPDX-License-Identifier: Apache-2.0
#include "clients/json/sensor_json.h"

namespace disparityd::json {
namespace {

Json vector_json(const disparity::SensorVector& vector) {
    return {vector.x, vector.y, vector.z};
}

}  // namespace

Json to_json(const disparity::SensorSample& sample, std::uint64_t skipped) {
    Json json{{"monotonic_ns", sample.monotonic_ns}, {"realtime_ns", sample.realtime_ns},
              {"camera_ns", sample.camera_ns},       {"skipped", skipped},
              {"lost", sample.lost_before},          {"frame_sync", sample.frame_sync}};
    if (sample.inertial) {
        json["angular_velocity"] = vector_json(sample.inertial->angular_velocity);
        json["acceleration"] = vector_json(sample.inertial->acceleration);
        json["imu_celsius"] = sample.inertial->celsius;
    }
    if (sample.magnetic_field) {
        json["magnetic_field"] = vector_json(*sample.magnetic_field);
    }
    if (sample.environment) {
        json["celsius"] = sample.environment->celsius;
        json["hectopascal"] = sample.environment->hectopascal;
        json["humidity_percent"] = sample.environment->humidity_percent;
    }
    if (sample.eye_temperatures) {
        json["left_celsius"] = sample.eye_temperatures->left_celsius;
        json["right_celsius"] = sample.eye_temperatures->right_celsius;
    }
    return json;
}

}  // namespace disparityd::json
