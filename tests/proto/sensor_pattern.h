// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "proto/disparity.pb.h"

/// Two samples, of inertial values and of the air.
inline disparityd::v1::Envelope sensor_message() {
    disparityd::v1::Envelope envelope;
    disparityd::v1::Sensors& sensors = *envelope.mutable_sensors();
    sensors.set_skipped(3);
    sensors.set_age_ns(5000);
    disparityd::v1::SensorSample& first = *sensors.add_samples();
    first.set_monotonic_ns(1000);
    first.set_realtime_ns(2000);
    first.set_camera_ns(3000);
    first.set_lost_before(4);
    first.mutable_inertial()->mutable_angular_velocity()->set_x(0.5F);
    first.mutable_inertial()->mutable_acceleration()->set_z(9.75F);
    first.mutable_inertial()->set_celsius(31);
    disparityd::v1::SensorSample& second = *sensors.add_samples();
    second.set_monotonic_ns(3'500'000);
    second.set_frame_sync(true);
    second.set_frame_syncs(7);
    second.mutable_environment()->set_hectopascal(1013.25F);
    return envelope;
}
