// SPDX-License-Identifier: Apache-2.0
//
// Samples of a camera's sensors from a recording through the real daemon, to a client and into another recording.
#include <gtest/gtest.h>

#include "capture/frame_source.h"
#include "capture/recording/recording_writer.h"
#include "clients/cpp/disparity_client.hpp"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

constexpr int samples_per_frame = 7;
constexpr int frames = 1200;
constexpr int all_samples = frames * samples_per_frame;

class SensorsTest : public DaemonTest {
protected:
    /// Frames with samples that are numbered by the camera's clock.
    std::string make_recording(std::optional<calibration::StereoCalibration> calibration = std::nullopt) const {
        capture::SourceInfo info;
        info.calibration = std::move(calibration);
        info.eye_width = 64;
        info.height = 48;
        info.rate = 60;
        const std::string path = folder_.path() + "/made.mkv";
        capture::RecordingWriter writer(path, info);
        std::vector<std::uint8_t> pixels(128 * 48, 100);
        std::vector<capture::SensorSample> samples(samples_per_frame);
        for (int i = 0; i < frames; ++i) {
            for (std::size_t k = 0; k < samples.size(); ++k) {
                samples[k].camera_ns = i * samples_per_frame + static_cast<int>(k);
                samples[k].monotonic_ns = 1'000'000 * samples[k].camera_ns;
                samples[k].flags = capture::sensor_flag_inertial;
                samples[k].acceleration.z = 9.75F;
            }
            capture::RawFrame frame;
            frame.image = {pixels.data(), info.format, info.eye_width, info.height, 128};
            frame.sequence = static_cast<std::uint64_t>(i);
            frame.monotonic_ns = frame.realtime_ns = 1'000'000'000LL * i / 60;
            frame.sensors = samples;
            writer.write(frame);
        }
        writer.close();
        return path;
    }
};

TEST_F(SensorsTest, SamplesOfARecordingReachClientsAndRecordings) {
    const auto daemon = start_ready(config_text(make_recording(), 0, 0), {"--set", "source.loop=true"});
    disparity::SocketClient listener(daemon->address("unix:"));
    disparity::Subscription subscription;
    subscription.sensors = true;
    listener.subscribe(subscription);
    WireClient recorder(daemon->address("unix:"));
    recorder.hello();
    ASSERT_TRUE(recorder.record("again.mkv"));
    std::int64_t last = -1;
    for (std::size_t samples = 0; samples < std::size_t{20} * samples_per_frame;) {
        disparity::SensorBatch batch;
        ASSERT_EQ(listener.read_sensors(batch, 20s), disparity::ReadResult::frame) << daemon->log();
        last += last < 0 ? 0 : static_cast<std::int64_t>(batch.skipped);
        EXPECT_GE(batch.age_ns, 0);
        EXPECT_LT(batch.age_ns, 60'000'000'000) << "since it was delivered, not since it was recorded";
        for (const disparity::SensorSample& sample : batch.samples) {
            EXPECT_TRUE(last < 0 || sample.camera_ns == (last + 1) % all_samples) << sample.camera_ns;
            EXPECT_EQ(sample.monotonic_ns, 1'000'000 * sample.camera_ns);
            EXPECT_TRUE(sample.inertial && sample.inertial->acceleration.z == 9.75F);
            last = sample.camera_ns;
        }
        samples += batch.samples.size();
    }
    disparity::Frame frame;
    EXPECT_EQ(listener.read(frame, 20s), disparity::ReadResult::frame);
    EXPECT_FALSE(status(recorder).has_sensors()) << "a recording has none that could be in trouble";
    while (status(recorder).record().frames() < 10) {
    }
    ASSERT_TRUE(recorder.record(""));

    capture::SourceOptions options;
    options.uri = folder_.path() + "/again.mkv";
    options.pace = capture::Pace::fastest;
    const auto again = capture::open_source(options);
    for (int i = 0; i < 10; ++i) {
        capture::RawFrame raw;
        ASSERT_EQ(again->next(raw, std::chrono::steady_clock::now() + 20s), capture::FrameSource::Next::frame);
        ASSERT_EQ(raw.sensors.size(), std::size_t{samples_per_frame});
        EXPECT_EQ(raw.sensors[0].camera_ns % samples_per_frame, 0);
        EXPECT_EQ(raw.sensors[6].camera_ns, raw.sensors[0].camera_ns + 6);
        EXPECT_EQ(raw.sensors[6].acceleration.z, 9.75F);
        again->give_back(raw);
    }
}

TEST_F(SensorsTest, TheStatusTellsWhereTheSensorStandsToTheRectifiedCamera) {
    calibration::StereoCalibration calibration;
    calibration.width = 64;
    calibration.height = 48;
    calibration.left = calibration.right = {60, 60, 31.5, 23.5, {}};
    // The right eye stands lower: both images are turned about z until their rows run from one eye to the other, along
    // (40, 9) / 41.
    calibration.translation = {-120, -27, 0};
    calibration.inertial.to_left_camera = calibration::Pose{{0, -1, 0, -1, 0, 0, 0, 0, -1}, {-20, -10, 5}};
    calibration.inertial.time_offset_s = -0.0025;
    calibration.inertial.accelerometer_noise_density = 2e-3;
    const auto daemon = start_ready(config_text(make_recording(calibration), 0, 0),
                                    {"--set", "source.loop=true", "--set", "source.time_offset_us=-1500"});
    disparity::SocketClient client(daemon->address("unix:"));
    const auto found = disparity::inertial_calibration(client.status(20s));
    ASSERT_TRUE(found && found->pose) << daemon->log();
    // By hand: x of the sensor was (0, -1, 0), so (-9, -40) / 41 of the turned camera; y was (-1, 0, 0).
    const std::array<double, 9> rotation{-9 / 41.0, -40 / 41.0, 0, -40 / 41.0, 9 / 41.0, 0, 0, 0, -1};
    // (-20, -10) turned: (-20 x 40 - 10 x 9) / 41 along the rows, (20 x 9 - 10 x 40) / 41 across them.
    const std::array<double, 3> translation{-890 / 41.0, -220 / 41.0, 5};
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_NEAR(found->pose->rotation[i], rotation[i], 1e-9) << i;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found->pose->translation_mm[i], translation[i], 1e-9) << i;
    }
    ASSERT_TRUE(found->time_offset_s);
    EXPECT_NEAR(*found->time_offset_s, -0.001, 1e-12) << "-1.5 ms of it are in the stamps";
    EXPECT_EQ(found->accelerometer_noise_density, 2e-3);
    EXPECT_FALSE(found->gyroscope_noise_density);
    disparity::Subscription subscription;
    client.subscribe(subscription);
    disparity::Frame frame;
    ASSERT_EQ(client.read(frame, 20s), disparity::ReadResult::frame);
    EXPECT_EQ(found->calibration_id, frame.calibration_id);
}

}  // namespace
}  // namespace disparityd::test
