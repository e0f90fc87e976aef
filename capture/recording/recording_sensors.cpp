// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_sensors.h"

#include <array>
#include <bit>

#include "base/little_endian.h"

namespace disparityd::capture::recording {

namespace {

constexpr std::size_t head_size = 8;
constexpr std::size_t sample_size = 96;

class Out {
public:
    explicit Out(std::span<std::uint8_t> bytes) : to_(bytes.data()) {}

    void number(std::uint64_t value, std::size_t bytes) {
        base::put_little_endian(to_, value, bytes);
        to_ += bytes;
    }
    void time(std::int64_t value) { number(static_cast<std::uint64_t>(value), 8); }
    void real(float value) { number(std::bit_cast<std::uint32_t>(value), 4); }
    void vector(const SensorVector& value) {
        real(value.x);
        real(value.y);
        real(value.z);
    }

private:
    std::uint8_t* to_;
};

class In {
public:
    explicit In(std::span<const std::uint8_t> bytes) : from_(bytes.data()) {}

    std::uint64_t number(std::size_t bytes) {
        const std::uint64_t value = base::get_little_endian(from_, bytes);
        from_ += bytes;
        return value;
    }
    std::int64_t time() { return static_cast<std::int64_t>(number(8)); }
    std::uint32_t word() { return static_cast<std::uint32_t>(number(4)); }
    float real() { return std::bit_cast<float>(word()); }
    SensorVector vector() {
        SensorVector value;
        value.x = real();
        value.y = real();
        value.z = real();
        return value;
    }

private:
    const std::uint8_t* from_;
};

constexpr std::array temperatures_and_air{
    &SensorSample::imu_celsius,      &SensorSample::celsius,      &SensorSample::hectopascal,
    &SensorSample::humidity_percent, &SensorSample::left_celsius, &SensorSample::right_celsius,
};

}  // namespace

std::size_t sensors_size(std::span<const SensorSample> samples) {
    return head_size + samples.size() * sample_size;
}

void put_sensors(std::span<const SensorSample> samples, std::span<std::uint8_t> bytes) {
    Out out(bytes);
    out.number(samples.size(), 4);
    out.number(sample_size, 4);
    for (const SensorSample& sample : samples) {
        out.time(sample.camera_ns);
        out.time(sample.monotonic_ns);
        out.time(sample.realtime_ns);
        out.number(sample.flags, 4);
        out.number(sample.lost_before, 4);
        out.number(sample.frame_syncs, 4);
        out.vector(sample.angular_velocity);
        out.vector(sample.acceleration);
        out.vector(sample.magnetic_field);
        for (const auto value : temperatures_and_air) {
            out.real(sample.*value);
        }
    }
}

std::optional<std::size_t> stored_sensors_size(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < head_size) {
        return bytes.empty() ? std::optional<std::size_t>(0) : std::nullopt;
    }
    In head(bytes);
    const std::uint64_t count = head.word();
    const std::uint64_t size = head.word();
    if (size < sample_size || count > (bytes.size() - head_size) / size) {
        return std::nullopt;
    }
    return head_size + count * size;
}

std::optional<std::vector<SensorSample>> get_sensors(std::span<const std::uint8_t> bytes) {
    if (!stored_sensors_size(bytes)) {
        return std::nullopt;
    }
    std::vector<SensorSample> samples;
    if (bytes.empty()) {
        return samples;
    }
    In head(bytes);
    samples.resize(head.word());
    const std::size_t size = head.word();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        In in(bytes.subspan(head_size + i * size));
        SensorSample& sample = samples[i];
        sample.camera_ns = in.time();
        sample.monotonic_ns = in.time();
        sample.realtime_ns = in.time();
        sample.flags = in.word();
        sample.lost_before = in.word();
        sample.frame_syncs = in.word();
        sample.angular_velocity = in.vector();
        sample.acceleration = in.vector();
        sample.magnetic_field = in.vector();
        for (const auto value : temperatures_and_air) {
            sample.*value = in.real();
        }
    }
    return samples;
}

}  // namespace disparityd::capture::recording
