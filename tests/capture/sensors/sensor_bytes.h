// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace disparityd::capture::test {

/// An input report of a camera's sensors, byte by byte; offsets are written out once more, so that the parser has
/// something to differ from.
struct SensorBytes {
    std::uint64_t ticks = 0;      ///< of 39062.5 ns
    std::int16_t gyro_x = 0;      ///< 1000/32768 degrees per second
    std::int16_t accel_z = 4096;  ///< 8 g / 32768
    std::uint8_t imu_not_valid = 0;
    std::uint8_t magnetometer = 0;  ///< 2: new
    std::uint8_t environment = 0;   ///< 2: new
    std::uint32_t pressure = 101'325;
    std::uint32_t humidity = 51'200;
    std::int16_t left_temperature = 3'950;
    std::uint8_t frame_sync = 0;
    std::uint32_t frame_syncs = 0;

    std::vector<std::uint8_t> report() const {
        std::vector<std::uint8_t> bytes(64, 0);
        const auto put = [&bytes](std::size_t offset, std::uint64_t value, std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) {
                bytes[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
            }
        };
        const auto put_count = [&put](std::size_t offset, std::int16_t value) {
            put(offset, static_cast<std::uint16_t>(value), 2);
        };
        bytes[0] = 1;
        bytes[1] = imu_not_valid;
        put(2, ticks, 8);
        put_count(10, gyro_x);
        put_count(12, -200);
        put_count(14, 32767);
        put_count(16, -1);
        put_count(18, 1);
        put_count(20, accel_z);
        bytes[22] = frame_sync;
        bytes[23] = 1;
        put(24, frame_syncs, 4);
        put_count(28, 3'112);
        bytes[30] = magnetometer;
        put_count(31, 320);
        put_count(33, -640);
        put_count(35, 8);
        bytes[47] = environment;
        put_count(48, -550);
        put(50, pressure, 4);
        put(54, humidity, 4);
        put_count(58, left_temperature);
        put_count(60, 4'025);
        return bytes;
    }
};

}  // namespace disparityd::capture::test
