// SPDX-License-Identifier: Apache-2.0
//
// What is recorded from a live camera is what the camera sent.
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include "capture/recording/recording_reader.h"
#include "tests/daemon/daemon_process.h"
#include "tests/daemon/wire_client.h"
#include "tests/vm/camera/sensor_report.h"
#include "tests/vm/camera/test_pattern.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {
namespace {

using disparityd::test::DaemonProcess;
using disparityd::test::TemporaryFolder;

struct Played {
    int frames = 0;
    std::uint64_t dropped = 0;  ///< as the frames say
    std::uint64_t sequences = 0;
};

/// Every frame is whole to the byte, later than the one before it, and says how many are missing in between.
Played play(const std::string& file, std::size_t frame_bytes) {
    const auto reader = disparityd::capture::open_recording_reader(file);
    std::vector<std::uint8_t> frame(reader->frame_bytes());
    EXPECT_EQ(frame.size(), frame_bytes);
    disparityd::capture::recording::FrameFacts facts;
    Played played;
    std::uint32_t last_number = 0;
    std::uint64_t first_sequence = 0;
    std::uint64_t last_sequence = 0;
    for (; reader->read(facts, frame.data()); ++played.frames) {
        EXPECT_EQ(simulated_camera::first_difference_from_pattern(frame), -1) << "frame " << played.frames;
        const std::uint32_t number = simulated_camera::pattern_number(frame);
        if (played.frames > 0) {
            EXPECT_GT(number, last_number);
            EXPECT_EQ(facts.sequence, last_sequence + 1 + facts.dropped_before);
            played.dropped += facts.dropped_before;
        } else {
            first_sequence = facts.sequence;
        }
        last_number = number;
        last_sequence = facts.sequence;
    }
    played.sequences = last_sequence + 1 - first_sequence;
    return played;
}

TEST(Record, EveryFrameIsWholeToTheByteAndInOrder) {
    const CameraProcess camera;
    const TemporaryFolder folder;
    const std::string file = folder.path() + "/live.mkv";
    DaemonProcess recording(folder, {"record", file, "--source", "v4l2:vga@15", "--frames", "30"}, {},
                            "/vm/disparityctl");
    ASSERT_EQ(recording.wait_for_exit(3 * patience), 0) << recording.log();
    EXPECT_EQ(play(file, 2U * 1344 * 376).frames, 30);
}

TEST(Record, WhatTheSensorsMeasuredStandsBesideTheFrames) {
    const CameraProcess camera({"--model", "zed2", "--sensors"});
    const TemporaryFolder folder;
    const std::string file = folder.path() + "/live.mkv";
    DaemonProcess recording(folder, {"record", file, "--source", "v4l2:vga@15", "--frames", "20"}, {},
                            "/vm/disparityctl");
    ASSERT_EQ(recording.wait_for_exit(3 * patience), 0) << recording.log();
    const auto reader = disparityd::capture::open_recording_reader(file);
    std::vector<std::uint8_t> frame(reader->frame_bytes());
    disparityd::capture::recording::FrameFacts facts;
    std::vector<disparityd::capture::SensorSample> samples;
    while (reader->read(facts, frame.data())) {
        samples.insert(samples.end(), facts.sensors.begin(), facts.sensors.end());
    }
    const auto number = [](const disparityd::capture::SensorSample& sample) {
        return std::lround(static_cast<double>(sample.angular_velocity.x) /
                           simulated_camera::angular_velocity_per_number);
    };
    ASSERT_GT(samples.size(), 15U) << recording.log();
    for (std::size_t i = 1; i < samples.size(); ++i) {
        EXPECT_EQ(number(samples[i]), number(samples[i - 1]) + 1) << "sample " << i;
        EXPECT_GT(samples[i].monotonic_ns, samples[i - 1].monotonic_ns) << "sample " << i;
    }
}

/// As long as the file /vm/record_seconds says (run --file), else short enough for every day.
std::string seconds_to_record() {
    std::string text = "2";
    std::ifstream("/vm/record_seconds") >> text;
    return text;
}

TEST(Record, NothingIsLostAtTheFullRateOfAnHd720Camera) {
    const CameraProcess camera;
    const TemporaryFolder folder;
    const std::string file = folder.path() + "/live.mkv";
    const std::string length = seconds_to_record();
    DaemonProcess recording(folder, {"record", file, "--source", "v4l2:hd720@15", "--seconds", length}, {},
                            "/vm/disparityctl");
    ASSERT_EQ(recording.wait_for_exit(3 * patience + seconds(2 * std::stoi(length))), 0) << recording.log();
    std::printf("%s%s\n", recording.output().c_str(), camera.tell("status").c_str());
    const Played played = play(file, 2U * 2560 * 720);
    EXPECT_EQ(played.dropped, 0U);
    EXPECT_EQ(played.sequences, static_cast<std::uint64_t>(played.frames));
}

/// A disk of a few megabytes, for as long as this lives.
class SmallDisk {
public:
    explicit SmallDisk(const std::string& place) : place_(place) {
        ::mkdir(place.c_str(), 0755);
        EXPECT_EQ(::mount("tmpfs", place.c_str(), "tmpfs", 0, "size=6m"), 0);
    }
    ~SmallDisk() { ::umount2(place_.c_str(), MNT_DETACH); }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

private:
    const std::string place_;
};

TEST(Record, AFullDiskEndsTheDaemonsRecordingAndNothingElse) {
    const CameraProcess camera;
    const SmallDisk disk("/tmp/small");
    LiveDaemon daemon("v4l2:vga@15", "/vm/disparityd",
                      {"record.directory=/tmp/small", "record.keep_free_mb=0", "source.stall_ms=15000"});
    ASSERT_TRUE(daemon.wait_for_new_frame());
    disparityd::test::WireClient client(daemon.address());
    client.hello();
    disparityd::v1::Envelope request;
    request.mutable_record_start()->set_path("full.mkv");
    client.send(request);
    ASSERT_TRUE(daemon.wait_for([](const LiveDaemon::Status& status) {
        return !status.record().active() && !status.record().error().empty();
    })) << daemon.log();
    const auto record = daemon.status().record();
    EXPECT_THAT(record.error(), testing::HasSubstr("full.mkv: cannot write: No space left on device"));
    EXPECT_THAT(daemon.log(), testing::HasSubstr(record.error()));
    EXPECT_TRUE(daemon.wait_for_new_frame());
    const Played played = play("/tmp/small/full.mkv", 2U * 1344 * 376);
    EXPECT_GT(played.frames, 0);
    EXPECT_EQ(static_cast<std::uint64_t>(played.frames), record.frames());
}

}  // namespace
}  // namespace vm_guest
