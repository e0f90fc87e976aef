// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_report.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/capture/sensors/sensor_bytes.h"

namespace disparityd::capture {
namespace {

using test::SensorBytes;

constexpr std::uint16_t old_firmware = 0x0308;

SensorSample parsed(const SensorBytes& bytes, std::uint16_t firmware = old_firmware) {
    const auto sample = parse_sensor_report(bytes.report(), firmware);
    EXPECT_TRUE(sample.has_value());
    return sample.value_or(SensorSample{});
}

TEST(SensorReport, GivesInertialValuesInUnits) {
    SensorBytes bytes;
    bytes.ticks = 1001;
    bytes.gyro_x = -16384;
    const SensorSample sample = parsed(bytes);
    EXPECT_EQ(sample.flags, sensor_flag_inertial);
    EXPECT_EQ(sample.camera_ns, 39'101'562) << "1001 ticks of 39062.5 ns, rounded down";
    EXPECT_NEAR(sample.angular_velocity.x, -8.726646, 1e-5) << "-500 degrees per second";
    EXPECT_NEAR(sample.angular_velocity.y, -0.1065263, 1e-6);
    EXPECT_NEAR(sample.angular_velocity.z, 17.45276, 1e-4);
    EXPECT_NEAR(sample.acceleration.x, -0.00239420, 1e-7);
    EXPECT_NEAR(sample.acceleration.y, 0.00239420, 1e-7);
    EXPECT_NEAR(sample.acceleration.z, 9.80665, 1e-5) << "1 g";
    EXPECT_NEAR(sample.imu_celsius, 31.12, 1e-5);
    EXPECT_EQ(sample.monotonic_ns, 0);
    EXPECT_EQ(sample.magnetic_field, SensorVector{});
    EXPECT_EQ(sample.hectopascal, 0);
}

TEST(SensorReport, ValuesThatAreNotValidAreLeftOut) {
    SensorBytes bytes;
    bytes.imu_not_valid = 1;
    bytes.magnetometer = 1;
    bytes.environment = 1;
    const SensorSample sample = parsed(bytes);
    EXPECT_EQ(sample, SensorSample{});
}

TEST(SensorReport, GivesTheMagneticFieldWhenItIsNew) {
    SensorBytes bytes;
    bytes.magnetometer = 2;
    const SensorSample sample = parsed(bytes);
    EXPECT_EQ(sample.flags, sensor_flag_inertial | sensor_flag_magnetic);
    EXPECT_EQ(sample.magnetic_field, (SensorVector{20, -40, 0.5F}));
}

TEST(SensorReport, ScaleOfTheAirDependsOnTheFirmware) {
    SensorBytes bytes;
    bytes.environment = 2;
    const SensorSample before = parsed(bytes, 0x0308);
    EXPECT_EQ(before.flags, sensor_flag_inertial | sensor_flag_environment | sensor_flag_eye_temperature);
    EXPECT_NEAR(before.celsius, -5.5, 1e-5);
    EXPECT_NEAR(before.hectopascal, 1013.25, 1e-3);
    EXPECT_NEAR(before.humidity_percent, 50, 1e-5);
    EXPECT_NEAR(before.left_celsius, 39.5, 1e-5);
    EXPECT_NEAR(before.right_celsius, 40.25, 1e-5);
    bytes.pressure = 10'132'500;
    bytes.humidity = 5'000;
    const SensorSample since = parsed(bytes, 0x0309);
    EXPECT_NEAR(since.hectopascal, 1013.25, 1e-3);
    EXPECT_NEAR(since.humidity_percent, 50, 1e-5);
}

TEST(SensorReport, EyesWithoutTemperature) {
    SensorBytes bytes;
    bytes.environment = 2;
    bytes.left_temperature = -27315;
    const SensorSample sample = parsed(bytes);
    EXPECT_EQ(sample.flags, sensor_flag_inertial | sensor_flag_environment);
    EXPECT_EQ(sample.right_celsius, 0);
}

TEST(SensorReport, SaysWhichSamplesBelongToAFrame) {
    SensorBytes bytes;
    bytes.frame_sync = 1;
    bytes.frame_syncs = 0x8000'0001U;
    const SensorSample sample = parsed(bytes);
    EXPECT_EQ(sample.flags, sensor_flag_inertial | sensor_flag_frame_sync);
    EXPECT_EQ(sample.frame_syncs, 0x8000'0001U);
}

TEST(SensorReport, OnlyWholeReportsOfTheRightKindAreTaken) {
    const std::vector<std::uint8_t> whole = SensorBytes().report();
    for (std::size_t size = 0; size <= whole.size(); ++size) {
        // An allocation of just this size, so that the sanitizers see a read behind its end.
        const std::vector<std::uint8_t> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_EQ(parse_sensor_report(part, old_firmware).has_value(), size >= 62) << size;
    }
    std::vector<std::uint8_t> other = whole;
    other[0] = 0;
    EXPECT_TRUE(parse_sensor_report(other, old_firmware)) << "a ZED Mini's";
    other[0] = 2;
    EXPECT_FALSE(parse_sensor_report(other, old_firmware));
}

TEST(SensorReport, TimesThatNoCameraReachesAreRefused) {
    SensorBytes bytes;
    bytes.ticks = std::uint64_t{1} << 47U;
    EXPECT_EQ(parsed(bytes).camera_ns, 5'497'558'138'880'000'000);
    ++bytes.ticks;
    EXPECT_FALSE(parse_sensor_report(bytes.report(), old_firmware));
    bytes.ticks = std::numeric_limits<std::uint64_t>::max();
    EXPECT_FALSE(parse_sensor_report(bytes.report(), old_firmware));
}

TEST(SensorReport, RandomBytesGiveNumbersWithinTheSensorsRanges) {
    std::mt19937 random(7);
    std::vector<std::uint8_t> bytes(64);
    for (int i = 0; i < 2000; ++i) {
        for (std::uint8_t& byte : bytes) {
            byte = static_cast<std::uint8_t>(random());
        }
        bytes[0] = 1;
        bytes[9] = bytes[8] = 0;
        bytes[7] &= 0x7f;
        const auto sample = parse_sensor_report(bytes, static_cast<std::uint16_t>(random()));
        ASSERT_TRUE(sample);
        EXPECT_LE(std::abs(sample->angular_velocity.y), 17.4534F);
        EXPECT_LE(std::abs(sample->acceleration.y), 78.4533F);
        EXPECT_LE(std::abs(sample->magnetic_field.y), 2048);
        EXPECT_GE(sample->camera_ns, 0);
    }
}

}  // namespace
}  // namespace disparityd::capture
