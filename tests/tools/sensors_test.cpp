// SPDX-License-Identifier: Apache-2.0
//
// disparityctl sensors, on a daemon that replays a recording with samples.
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "capture/frame_source.h"
#include "capture/recording/recording_writer.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

constexpr int recorded_frames = 600;
constexpr int samples_per_frame = 5;
constexpr int all_samples = recorded_frames * samples_per_frame;

/// Frames of an even grey, each with samples before it; the clock of the samples counts them.
void make_recording_with_sensors(const std::string& path) {
    capture::SourceInfo info;
    info.eye_width = 64;
    info.height = 48;
    info.rate = 60;
    capture::RecordingWriter writer(path, info);
    const std::vector<std::uint8_t> pixels(128 * 48, 100);
    std::vector<capture::SensorSample> samples(samples_per_frame);
    std::int64_t count = 0;
    for (int i = 0; i < recorded_frames; ++i) {
        for (capture::SensorSample& sample : samples) {
            sample.camera_ns = count++;
            sample.flags = capture::sensor_flag_inertial | capture::sensor_flag_environment;
            sample.acceleration = {0, -9.75F, 0};
            sample.hectopascal = 1013.25F;
        }
        capture::RawFrame frame;
        frame.image = {pixels.data(), info.format, info.eye_width, info.height, 128};
        frame.sequence = static_cast<std::uint64_t>(i);
        frame.monotonic_ns = 1'000'000'000LL * i / 60;
        frame.sensors = samples;
        writer.write(frame);
    }
    writer.close();
}

/// A daemon with a socket of its own, and nothing else that clients could reach.
class SensorDaemonTest : public FolderTest {
protected:
    /// Until its status holds the text.
    void start(const std::string& source, std::vector<std::string> settings, const std::string& ready) {
        const std::string id = "dctl-sensors-" + std::to_string(getpid());
        socket_ = "unix:/tmp/" + id + ".sock";
        settings.insert(settings.end(), {"socket.unix=" + socket_.substr(5), "socket.tcp="});
        std::vector<std::string> arguments{"--source", source, "--name", id};
        for (const std::string& setting : settings) {
            arguments.insert(arguments.end(), {"--set", setting});
        }
        daemon_ = std::make_unique<Program>(DISPARITYD, arguments);
        ASSERT_TRUE(eventually([&] {
            const Outcome status = run(DISPARITYCTL, {"status", "--socket", socket_});
            return !daemon_->running() || (status.exit_code == 0 && status.out.find(ready) != std::string::npos);
        }));
        ASSERT_TRUE(daemon_->running()) << daemon_->wait().err;
    }

    void TearDown() override {
        if (daemon_) {
            daemon_->send(SIGTERM);
            daemon_->wait();
        }
        FolderTest::TearDown();
    }

    std::string socket_;
    std::unique_ptr<Program> daemon_;
};

class SensorsTest : public SensorDaemonTest {
protected:
    void SetUp() override {
        SensorDaemonTest::SetUp();
        make_recording_with_sensors(path("made.mkv"));
        start(path("made.mkv"), {"match.disparities=16", "source.loop=true"}, "");
    }
};

TEST_F(SensorsTest, JsonHasEverySample) {
    const Outcome outcome = run(DISPARITYCTL, {"sensors", "--socket", socket_, "--count", "40", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    int count = 0;
    std::int64_t last = -1;
    for (std::string line; std::getline(lines, line); ++count) {
        const auto sample = nlohmann::json::parse(line);
        EXPECT_EQ(sample["acceleration"], (nlohmann::json{0.0, -9.75, 0.0}));
        EXPECT_EQ(sample["hectopascal"], 1013.25);
        EXPECT_FALSE(sample.contains("magnetic_field"));
        const auto number = sample["camera_ns"].get<std::int64_t>();
        EXPECT_TRUE(last < 0 ||
                    number == (last + 1 + sample["skipped"].get<std::int64_t>() + sample["lost"].get<std::int64_t>()) %
                                  all_samples)
            << number;
        last = number;
    }
    EXPECT_EQ(count, 40);
}

/// A daemon whose camera is not there, and whose name would colour a terminal.
class AbsentCameraTest : public SensorDaemonTest {
protected:
    void SetUp() override {
        SensorDaemonTest::SetUp();
        start("v4l2:hd720@30?port=\x1b[31mRED", {}, "plug it in");
    }
};

TEST_F(AbsentCameraTest, TheReasonIsPrintable) {
    const Outcome outcome = run(DISPARITYCTL, {"sensors", "--socket", socket_, "--count", "1"});
    EXPECT_THAT(outcome.out, HasSubstr("no sample: "));
    EXPECT_THAT(outcome.out, HasSubstr("RED"));
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << outcome.out;
}

TEST_F(AbsentCameraTest, JsonSaysWhyNothingComes) {
    Program show(DISPARITYCTL, {"sensors", "--socket", socket_, "--json"});
    EXPECT_TRUE(eventually([&] { return !show.running() || show.said("no sample: "); }));
    show.send(SIGINT);
    const Outcome outcome = show.wait();
    EXPECT_THAT(outcome.err, HasSubstr("plug it in"));
    EXPECT_EQ(outcome.out, "");
}

TEST_F(SensorsTest, ALineForEachSecond) {
    Program show(DISPARITYCTL, {"sensors", "--socket", socket_});
    ASSERT_TRUE(eventually([&] { return !show.running() || show.said("1013.25 hPa"); }));
    show.send(SIGINT);
    const Outcome outcome = show.wait();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("acceleration, m/s2"));
    EXPECT_THAT(outcome.out, HasSubstr("-9.750"));
}

}  // namespace
}  // namespace disparityd::test
