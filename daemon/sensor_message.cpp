// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor_message.h"

#include "proto/text.h"

namespace disparityd::daemon {

namespace {

void fill_vector(const capture::SensorVector& vector, v1::Vector& message) {
    message.set_x(vector.x);
    message.set_y(vector.y);
    message.set_z(vector.z);
}

}  // namespace

void fill_message(const capture::SensorSample& sample, v1::SensorSample& message) {
    message.set_monotonic_ns(sample.monotonic_ns);
    message.set_realtime_ns(sample.realtime_ns);
    message.set_camera_ns(sample.camera_ns);
    message.set_lost_before(sample.lost_before);
    message.set_frame_sync((sample.flags & capture::sensor_flag_frame_sync) != 0);
    message.set_frame_syncs(sample.frame_syncs);
    if ((sample.flags & capture::sensor_flag_inertial) != 0) {
        v1::Inertial& inertial = *message.mutable_inertial();
        fill_vector(sample.angular_velocity, *inertial.mutable_angular_velocity());
        fill_vector(sample.acceleration, *inertial.mutable_acceleration());
        inertial.set_celsius(sample.imu_celsius);
    }
    if ((sample.flags & capture::sensor_flag_magnetic) != 0) {
        fill_vector(sample.magnetic_field, *message.mutable_magnetic_field());
    }
    if ((sample.flags & capture::sensor_flag_environment) != 0) {
        v1::Environment& environment = *message.mutable_environment();
        environment.set_celsius(sample.celsius);
        environment.set_hectopascal(sample.hectopascal);
        environment.set_humidity_percent(sample.humidity_percent);
    }
    if ((sample.flags & capture::sensor_flag_eye_temperature) != 0) {
        message.mutable_eye_temperatures()->set_left_celsius(sample.left_celsius);
        message.mutable_eye_temperatures()->set_right_celsius(sample.right_celsius);
    }
}

v1::SensorStatus to_message(const capture::SensorFacts& sensors) {
    v1::SensorStatus message;
    message.set_state(capture::to_string(sensors.state));
    message.set_detail(proto::to_valid_utf8(sensors.detail));
    message.set_node(sensors.node);
    message.set_samples(sensors.samples);
    message.set_lost(sensors.lost);
    message.set_refused(sensors.refused);
    message.set_clock_jumps(sensors.clock_jumps);
    message.set_drift_ppm(sensors.drift * 1e6);
    return message;
}

v1::InertialCalibration to_message(const calibration::InertialCalibration& inertial,
                                   const std::array<double, 9>& to_rectified, int moved_us) {
    v1::InertialCalibration message;
    if (inertial.to_left_camera) {
        const calibration::Pose pose = chained(*inertial.to_left_camera, {to_rectified, {}});
        message.mutable_pose()->mutable_rotation()->Assign(pose.rotation.begin(), pose.rotation.end());
        message.mutable_pose()->mutable_translation_mm()->Assign(pose.translation.begin(), pose.translation.end());
    }
    if (inertial.time_offset_s) {
        message.mutable_time_offset()->set_seconds(*inertial.time_offset_s - 1e-6 * moved_us);
    }
    message.set_gyroscope_noise_density(inertial.gyroscope_noise_density.value_or(0));
    message.set_gyroscope_random_walk(inertial.gyroscope_random_walk.value_or(0));
    message.set_accelerometer_noise_density(inertial.accelerometer_noise_density.value_or(0));
    message.set_accelerometer_random_walk(inertial.accelerometer_random_walk.value_or(0));
    return message;
}

}  // namespace disparityd::daemon
