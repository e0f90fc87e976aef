// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::capture {

/// What a SensorSample holds, as a bit set; numbers of a recording.
enum SensorFlag : std::uint32_t {
    sensor_flag_inertial = 1U << 0,         ///< angular velocity, acceleration, imu_celsius
    sensor_flag_magnetic = 1U << 1,         ///< a new magnetic field
    sensor_flag_environment = 1U << 2,      ///< new celsius, hectopascal, humidity_percent
    sensor_flag_eye_temperature = 1U << 3,  ///< new left_celsius, right_celsius
    sensor_flag_frame_sync = 1U << 4,       ///< measured at the instant of a frame's exposure
};

/// Along the axes of the sensor, as the camera sends them: nothing is rotated or calibrated here.
struct SensorVector {
    float x = 0;
    float y = 0;
    float z = 0;

    bool operator==(const SensorVector&) const = default;
};

/// What the sensors of a camera measured at one instant. Values whose flag is not set are 0.
struct SensorSample {
    std::int64_t camera_ns = 0;     ///< on the camera's clock, which starts anywhere
    std::int64_t monotonic_ns = 0;  ///< the same instant on CLOCK_MONOTONIC (as recorded, when replayed)
    std::int64_t realtime_ns = 0;   ///< the same instant on CLOCK_REALTIME (as recorded, when replayed)
    std::uint32_t flags = 0;        ///< SensorFlag bits
    std::uint32_t lost_before = 0;  ///< samples that this program lost between the one before and this
    std::uint32_t frame_syncs = 0;  ///< the camera's count of frames that its sensors were synchronised with
    SensorVector angular_velocity;  ///< rad/s
    SensorVector acceleration;      ///< m/s², gravity included
    SensorVector magnetic_field;    ///< µT
    float imu_celsius = 0;
    float celsius = 0;           ///< inside the camera
    float hectopascal = 0;       ///< of the air
    float humidity_percent = 0;  ///< relative
    float left_celsius = 0;      ///< of the left image sensor
    float right_celsius = 0;

    bool operator==(const SensorSample&) const = default;
};

}  // namespace disparityd::capture
