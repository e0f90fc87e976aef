// SPDX-License-Identifier: Apache-2.0
#include "tests/capture/recording/record_fixture.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "capture/recording/recording_source.h"
#include "capture/recording/recording_writer.h"

namespace disparityd::capture::test {

SourceInfo make_info(PixelFormat format, int eye_width, int height) {
    SourceInfo info;
    info.name = "scene:test";
    info.format = format;
    info.eye_width = eye_width;
    info.height = height;
    info.rate = 30000.0 / 1001.0;
    return info;
}

calibration::StereoCalibration make_calibration(int width, int height) {
    calibration::StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    const double w = width;
    const double h = height;
    calibration.left = {0.7123456789012345 * w, 0.69 * w, w / 3, h / 7, {-0.17, 0.026, 1e-17, -3e-5, 0.1}};
    calibration.right = {0.7 * w, 0.71 * w, 0.4 * w, 0.6 * h, {-0.16, 0.025, 1e-4, 0, 0}};
    calibration.rotation = {1, 0.001, -0.002, -0.001, 1, 0.003, 0.002, -0.003, 1};
    calibration.translation = {-119.95, 0.01, -1e-3};
    calibration.origin = "SN1234.conf";
    return calibration;
}

SensorSample make_sample(int number) {
    SensorSample sample;
    sample.camera_ns = 2'500'000 * static_cast<std::int64_t>(number);
    sample.monotonic_ns = -number;
    sample.realtime_ns = std::numeric_limits<std::int64_t>::max() - number;
    sample.flags = 0xffff'ffffU - static_cast<std::uint32_t>(number);
    sample.lost_before = 0x8000'0000U;
    sample.frame_syncs = static_cast<std::uint32_t>(number);
    const auto value = static_cast<float>(number);
    sample.angular_velocity = {value, value + 0.1F, -value};
    sample.acceleration = {value + 0.2F, 0, std::numeric_limits<float>::infinity()};
    sample.magnetic_field = {value + 0.3F, value + 0.4F, value + 0.5F};
    sample.imu_celsius = value + 1;
    sample.celsius = value + 2;
    sample.hectopascal = value + 3;
    sample.humidity_percent = value + 4;
    sample.left_celsius = value + 5;
    sample.right_celsius = value + 6;
    return sample;
}

OwnedFrame make_frame(const SourceInfo& info, int number) {
    OwnedFrame made;
    const int row = 2 * info.eye_width * bytes_per_pixel(info.format);
    const int stride = row + 5;
    made.bytes.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(info.height), 0xEE);
    std::mt19937 random(static_cast<unsigned>(number) + 1);
    for (int y = 0; y < info.height; ++y) {
        for (int x = 0; x < row; ++x) {
            const int smooth = number % 4 == 0 ? 255 * (number / 4 % 2) : x + 3 * y + number;
            const int value = number % 2 == 1 ? static_cast<int>(random()) : smooth;
            made.bytes[static_cast<std::size_t>(y) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(x)] =
                static_cast<std::uint8_t>(value);
        }
    }
    made.frame.image = {made.bytes.data(), info.format, info.eye_width, info.height, stride};
    made.frame.sequence = 0xFFFF'FFFF'0000U + static_cast<std::uint64_t>(3 * number);
    made.frame.monotonic_ns = 123'456'789'012'345 + static_cast<std::int64_t>(number) * 33'366'701;
    made.frame.realtime_ns = 1'790'000'000'123'456'789 + static_cast<std::int64_t>(number) * 33'366'699;
    made.frame.flags = number % 3 == 1 ? 0x8000'0000U | frame_flag_corrupt : 0;
    made.frame.dropped_before = number == 0 ? 0 : 2;
    made.frame.correction = number < 2 ? calibration::CalibrationCorrection{}
                                       : calibration::CalibrationCorrection{number, -2'147'483'647, 1 << 30, -1};
    for (int i = 0; i < number % 3; ++i) {
        made.sensors.push_back(make_sample(100 * number + i));
    }
    made.frame.sensors = made.sensors;
    return made;
}

SeenFrame seen(const RawFrame& frame) {
    SeenFrame seen;
    const auto row = 2 * static_cast<std::size_t>(frame.image.eye_width) *
                     static_cast<std::size_t>(bytes_per_pixel(frame.image.format));
    seen.pixels.resize(row * static_cast<std::size_t>(frame.image.height));
    for (int y = 0; y < frame.image.height; ++y) {
        std::memcpy(seen.pixels.data() + static_cast<std::size_t>(y) * row, frame.image.data + y * frame.image.stride,
                    row);
    }
    seen.sequence = frame.sequence;
    seen.monotonic_ns = frame.monotonic_ns;
    seen.realtime_ns = frame.realtime_ns;
    seen.flags = frame.flags;
    seen.dropped_before = frame.dropped_before;
    seen.correction = frame.correction;
    seen.sensors.assign(frame.sensors.begin(), frame.sensors.end());
    return seen;
}

void write_recording(const std::string& path, const SourceInfo& info, int count) {
    RecordingWriter writer(path, info);
    for (int i = 0; i < count; ++i) {
        writer.write(make_frame(info, i).frame);
    }
    writer.close();
}

Replay replay(const std::string& path, bool loop, std::size_t limit) {
    SourceOptions options;
    options.uri = path;
    options.loans = 2;
    options.pace = Pace::fastest;
    options.loop = loop;
    const auto source = open_recording(options);
    Replay result;
    result.info = source->info();
    try {
        while (result.frames.size() < limit) {
            RawFrame frame;
            const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
            const auto next = source->next(frame, deadline);
            if (next != FrameSource::Next::frame) {
                EXPECT_EQ(next, FrameSource::Next::end);
                break;
            }
            result.frames.push_back(seen(frame));
            source->give_back(frame);
        }
    } catch (const std::runtime_error& error) {
        result.error = error.what();
        RawFrame frame;
        EXPECT_EQ(source->next(frame, std::chrono::steady_clock::now()), FrameSource::Next::end);
    }
    return result;
}

std::string refusal(const std::string& path) {
    try {
        replay(path);
        ADD_FAILURE() << path << " was opened";
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(std::count(error.what(), error.what() + std::strlen(error.what()), '\n'), 0) << error.what();
        return error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << "another type: " << error.what();
    }
    return {};
}

std::vector<std::uint8_t> file_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void put_file(const std::string& path, const std::uint8_t* bytes, std::size_t size) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

}  // namespace disparityd::capture::test
