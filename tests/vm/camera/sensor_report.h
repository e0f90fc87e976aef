// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numbers>

#include "tests/vm/camera/byte_order.h"

namespace simulated_camera {

/// The camera's clock runs with the system's CLOCK_MONOTONIC, so many nanoseconds ahead; in ticks of 39062.5 ns.
inline constexpr std::int64_t sensor_clock_ahead_ns = 1'000'000'000'000;

/// One in so many reports has the field, the air and the temperatures.
inline constexpr std::uint32_t reports_per_environment = 10;

/// The input report with this number: 1 g along z, at rest but for the x axis, whose gyroscope counts the reports from
/// 0 to 32767 and begins again.
Bytes sensor_report(std::uint32_t number, std::int64_t monotonic_ns);

/// Angular velocity about x, rad/s, that the report with a number shows for each unit of the number (below 32768).
inline constexpr double angular_velocity_per_number = 1000.0 / 32768 * std::numbers::pi / 180;

}  // namespace simulated_camera
