// SPDX-License-Identifier: Apache-2.0
//
// The HID reports of the sensors in ZED Mini, ZED 2 and ZED 2i. Their layout, scales and requests are facts that the
// maker's published open capture library (zed-open-capture: sensorcapture_def.hpp, sensorcapture.cpp) documents. None
// of it has been verified on a real camera yet; the tests and the simulator only hold this program to those facts.
// In particular open: the first byte of a ZED Mini's report (that library expects 0 there, and 1 of the others; both
// are taken), which firmware numbers of a ZED 2i go with which scale of pressure and humidity (taken as of a ZED 2),
// and which directions the axes have.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "capture/sensor_sample.h"

namespace disparityd::capture {

/// Bytes of an input report; further ones are ignored.
inline constexpr std::size_t sensor_report_bytes = 62;

/// Reads an input report as hidraw gives it, in physical units; the host's times stay 0. `firmware` is the bcdDevice of
/// the sensor device: from 0x0309 on, pressure and humidity come in other units. Returns nullopt when the report is too
/// short, is another report, or has a time that no camera reaches. Any bytes may come; pure.
std::optional<SensorSample> parse_sensor_report(std::span<const std::uint8_t> report, std::uint16_t firmware);

/// Feature reports, number first.
using SensorRequest = std::array<std::uint8_t, 2>;

/// Lets the camera send input reports. It stops about six seconds after the last sensor_ping.
inline constexpr SensorRequest sensor_stream_on{0x32, 1};
inline constexpr SensorRequest sensor_ping{0x21, 0xf2};

}  // namespace disparityd::capture
