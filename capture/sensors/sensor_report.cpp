// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_report.h"

#include <numbers>

#include "base/little_endian.h"

namespace disparityd::capture {

namespace {

/// Offsets of the fields, which are packed, little endian.
namespace at {
constexpr std::size_t report_number = 0;
constexpr std::size_t imu_not_valid = 1;
constexpr std::size_t ticks = 2;
constexpr std::size_t angular_velocity = 10;
constexpr std::size_t acceleration = 16;
constexpr std::size_t frame_sync = 22;
constexpr std::size_t frame_sync_count = 24;
constexpr std::size_t imu_temperature = 28;
constexpr std::size_t magnetometer_state = 30;
constexpr std::size_t magnetic_field = 31;
constexpr std::size_t environment_state = 47;
constexpr std::size_t temperature = 48;
constexpr std::size_t pressure = 50;
constexpr std::size_t humidity = 54;
constexpr std::size_t left_temperature = 58;
constexpr std::size_t right_temperature = 60;
}  // namespace at

constexpr std::uint8_t data_report = 1;
constexpr std::uint8_t new_value = 2;  // of the states: 0 no such sensor, 1 measured before
constexpr std::int16_t no_temperature = -27315;
constexpr std::uint16_t firmware_with_fine_air = 0x0309;

constexpr float radians_per_count = static_cast<float>(1000.0 / 32768 * std::numbers::pi / 180);
// The range is 8 g, of standard gravity; the maker's library multiplies by 9.8189 instead.
constexpr float acceleration_per_count = static_cast<float>(8.0 / 32768 * 9.80665);
constexpr float microtesla_per_count = 1.0F / 16;
constexpr float celsius_per_count = 0.01F;

// A tick is 39062.5 ns: 2^47 of them are 174 years.
constexpr std::uint64_t most_ticks = std::uint64_t{1} << 47U;

class Fields {
public:
    explicit Fields(std::span<const std::uint8_t, sensor_report_bytes> bytes) : bytes_(bytes) {}

    std::uint64_t number(std::size_t offset, std::size_t bytes) const {
        return base::get_little_endian(&bytes_[offset], bytes);
    }

    std::int16_t count(std::size_t offset) const { return static_cast<std::int16_t>(number(offset, 2)); }

    SensorVector vector(std::size_t offset, float unit) const {
        return {static_cast<float>(count(offset)) * unit, static_cast<float>(count(offset + 2)) * unit,
                static_cast<float>(count(offset + 4)) * unit};
    }

    float celsius(std::size_t offset) const { return static_cast<float>(count(offset)) * celsius_per_count; }

private:
    std::span<const std::uint8_t, sensor_report_bytes> bytes_;
};

void read_environment(const Fields& fields, std::uint16_t firmware, SensorSample& sample) {
    const bool fine = firmware >= firmware_with_fine_air;
    sample.flags |= sensor_flag_environment;
    sample.celsius = fields.celsius(at::temperature);
    sample.hectopascal = static_cast<float>(fields.number(at::pressure, 4)) * (fine ? 0.0001F : 0.01F);
    sample.humidity_percent = static_cast<float>(fields.number(at::humidity, 4)) * (fine ? 0.01F : 1.0F / 1024);
    // The image sensors' temperatures are measured together with these.
    if (fields.count(at::left_temperature) != no_temperature && fields.count(at::right_temperature) != no_temperature) {
        sample.flags |= sensor_flag_eye_temperature;
        sample.left_celsius = fields.celsius(at::left_temperature);
        sample.right_celsius = fields.celsius(at::right_temperature);
    }
}

}  // namespace

std::optional<SensorSample> parse_sensor_report(std::span<const std::uint8_t> report, std::uint16_t firmware) {
    if (report.size() < sensor_report_bytes || report[at::report_number] > data_report) {
        return std::nullopt;
    }
    const Fields fields(report.first<sensor_report_bytes>());
    const std::uint64_t ticks = fields.number(at::ticks, 8);
    if (ticks > most_ticks) {
        return std::nullopt;
    }
    SensorSample sample;
    sample.camera_ns = static_cast<std::int64_t>(ticks * 78'125 / 2);
    sample.frame_syncs = static_cast<std::uint32_t>(fields.number(at::frame_sync_count, 4));
    sample.flags = report[at::frame_sync] != 0 ? sensor_flag_frame_sync : 0U;
    if (report[at::imu_not_valid] == 0) {
        sample.flags |= sensor_flag_inertial;
        sample.angular_velocity = fields.vector(at::angular_velocity, radians_per_count);
        sample.acceleration = fields.vector(at::acceleration, acceleration_per_count);
        sample.imu_celsius = fields.celsius(at::imu_temperature);
    }
    if (report[at::magnetometer_state] == new_value) {
        sample.flags |= sensor_flag_magnetic;
        sample.magnetic_field = fields.vector(at::magnetic_field, microtesla_per_count);
    }
    if (report[at::environment_state] == new_value) {
        read_environment(fields, firmware, sample);
    }
    return sample;
}

}  // namespace disparityd::capture
