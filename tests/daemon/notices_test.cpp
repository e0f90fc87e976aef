// SPDX-License-Identifier: Apache-2.0
//
// What the real daemon says when the system does not give it what it asks for; it runs all the same.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <sys/prctl.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* many_workers = "pipeline.workers=256";

class NoticesTest : public DaemonTest {
protected:
    /// Its status after `frames` frames.
    v1::Status status_after(const DaemonProcess& daemon, int frames) {
        WireClient client = subscriber(daemon.address("tcp:"), {v1::DISPARITY});
        for (int i = 0; i < frames; ++i) {
            EXPECT_TRUE(client.receive_frame());
        }
        return status(client);
    }
};

TEST_F(NoticesTest, WorkersWithoutCoresOfTheirOwn) {
    const auto daemon = start_ready(config_text(), {"--set", many_workers});
    EXPECT_THAT(status_after(*daemon, 1).notices(), Contains(HasSubstr("not pinned to cores: 256 workers share")));
    EXPECT_THAT(daemon->log(), HasSubstr("256 workers, not pinned to cores"));
}

TEST_F(NoticesTest, WhichDistancesAreMeasuredIsToldOnce) {
    const auto daemon = start_ready(config_text());
    ASSERT_TRUE(daemon->wait_for_log("at 10 m a step of 1/16 px is ")) << daemon->log();
    const std::string log = daemon->log();
    const std::string line = "nothing nearer than ";
    const auto first = log.find(line);
    ASSERT_NE(first, std::string::npos) << log;
    EXPECT_EQ(log.find(line, first + 1), std::string::npos) << log;
}

TEST_F(NoticesTest, WhatIsSwitchedOffIsNoNews) {
    const auto daemon = start_ready(config_text(), {"--set", many_workers, "--set", "pipeline.pin_workers=false"});
    EXPECT_THAT(status_after(*daemon, 1).notices(), Not(Contains(HasSubstr("pinned"))));
}

TEST_F(NoticesTest, NoHugePages) {
    // The daemon inherits it.
    ASSERT_EQ(prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0), 0);
    const auto daemon = start_ready(config_text(), {"--set", "match.method=sgm", "--set", "match.disparities=256"});
    prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
    ASSERT_TRUE(daemon->wait_for_log("no huge pages")) << daemon->log();
    EXPECT_THAT(status_after(*daemon, 1).notices(), Contains(HasSubstr("no huge pages")));
}

TEST_F(NoticesTest, HowMuchIsMeasuredOfAScene) {
    const auto daemon = start_ready(config_text());
    const v1::Status status = status_after(*daemon, 2);  // the first is counted before the second is published
    EXPECT_GT(status.measured().ratio(), 0.5);
    EXPECT_LE(status.measured().ratio(), 1);
    EXPECT_EQ(status.measured().likely_cause(), "");
    EXPECT_GT(status.trust().ratio(), 0.5);
    EXPECT_THAT(status.trust().doubts(), IsEmpty());
}

// Eyes that are covered see noise.
TEST_F(NoticesTest, WhyHardlyAnythingIsMeasured) {
    const TemporaryFolder folder;
    std::mt19937 random(1);
    for (const char* eye : {"left", "right"}) {
        std::filesystem::create_directory(folder.file(eye));
        std::ofstream image(folder.file(std::string(eye) + "/1.pgm"), std::ios::binary);
        image << "P5\n320 240\n255\n";
        for (int i = 0; i < 320 * 240; ++i) {
            image.put(static_cast<char>(2 + random() % 2));
        }
    }
    const auto daemon = start_ready(config_text(), {"--set", "source.uri=\"" + folder.path() + "\"", "--set",
                                                    "source.loop=true", "--set", "source.allow_unrectified=true"});
    ASSERT_TRUE(daemon->wait_for_log("the likely cause: the images have no texture")) << daemon->log();
    const v1::Status status = status_after(*daemon, 1);
    ASSERT_TRUE(status.has_measured());
    EXPECT_LT(status.measured().ratio(), 0.1);
    EXPECT_THAT(status.measured().likely_cause(), HasSubstr("no texture"));
}

// A texture with plain stripes, and a cap before the right eye.
TEST_F(NoticesTest, ACoveredEyeIsAnAlarm) {
    const TemporaryFolder folder;
    std::string texture;
    for (int i = 0; i < 320 * 240; ++i) {
        const int block = i / 320 / 4 * 80 + i % 320 / 4;
        const bool plain = i / 320 % 48 < 24;
        texture += static_cast<char>(plain ? 90 : std::minstd_rand(static_cast<unsigned>(block) + 1)() % 211);
    }
    for (const bool left : {true, false}) {
        const std::string eye = folder.file(left ? "left" : "right");
        std::filesystem::create_directory(eye);
        std::ofstream(eye + "/0.pgm", std::ios::binary) << "P5\n320 240\n255\n"
                                                        << (left ? texture : std::string(texture.size(), 9));
        for (int i = 1; i < 60; ++i) {
            std::filesystem::create_hard_link(eye + "/0.pgm", eye + '/' + std::to_string(i) + ".pgm");
        }
    }
    const auto daemon = start_ready(
        config_text(), {"--set", "source.uri=\"" + folder.path() + "\"", "--set", "source.allow_unrectified=true"});
    ASSERT_TRUE(daemon->wait_for_log("alarm covered-eye: one eye sees nothing")) << daemon->log();
    WireClient client(daemon->address("tcp:"));
    client.hello();
    const v1::Status status = test::status(client);
    EXPECT_THAT(status.trust().doubts(), Contains("covered-eye"));
    EXPECT_THAT(status.trust().alarm(), HasSubstr("uncover it"));
    EXPECT_LT(status.trust().ratio(), 0.1);
}

TEST_F(NoticesTest, TrustCanBeSwitchedOff) {
    const auto daemon = start_ready(config_text(), {"--set", "trust.enabled=false"});
    EXPECT_FALSE(status_after(*daemon, 2).has_trust());
}

// A scene has no inertial sensor.
TEST_F(NoticesTest, AGroundThatNoSensorGives) {
    const auto daemon = start_ready(config_text(), {"--set", "scan.enabled=true", "--set", "scan.ground=gravity",
                                                    "--set", "scan.imu_axes=ahead left up"});
    EXPECT_THAT(status_after(*daemon, 1).notices(), Contains(HasSubstr("obstacle scans take the configured ground")));
}

TEST_F(NoticesTest, AGroundThatNeedsNoSensor) {
    const auto daemon = start_ready(config_text(), {"--set", "scan.enabled=true"});
    EXPECT_THAT(status_after(*daemon, 1).notices(), Not(Contains(HasSubstr("configured ground"))));
}

// A rendered scene must not be taken for what a camera sees: not live, not as a recording of it.
TEST_F(NoticesTest, ASceneIsToldAsSynthetic) {
    const auto expect_synthetic = [](const DaemonProcess& daemon) {
        WireClient client = subscriber(daemon.address("tcp:"), {v1::DISPARITY});
        const auto frame = client.receive_frame();
        ASSERT_TRUE(frame);
        EXPECT_NE(frame->envelope.frame().flags() & v1::SYNTHETIC, 0U);
        EXPECT_TRUE(status(client).synthetic());
        EXPECT_THAT(status(client).notices(), Contains(HasSubstr("synthetic")));
        EXPECT_TRUE(daemon.wait_for_log("the frames are synthetic, no camera saw them"));
    };
    {
        const auto daemon = start_ready(config_text());
        expect_synthetic(*daemon);
        WireClient recorder(daemon->address("unix:"));
        recorder.hello();
        ASSERT_TRUE(recorder.record("drawn.mkv"));
        while (status(recorder).record().frames() == 0) {
        }
        EXPECT_TRUE(recorder.record(""));
    }
    expect_synthetic(*start_ready(config_text(folder_.path() + "/drawn.mkv"), {"--set", "source.loop=true"}));
}

// A disk that is too slow and frames that come too fast are the same to a recorder: its buffers are full.
TEST_F(NoticesTest, ARecordingThatLosesFramesSaysSoOnceAndIsValid) {
    const std::string slow =
        "slow.mkv: frames come faster than they can be written and are dropped: record to a faster";
    {
        const auto daemon = start_ready(config_text("scene:hd720@1000?loop=2"));
        WireClient client(daemon->address("unix:"));
        client.hello();
        ASSERT_TRUE(client.record("slow.mkv"));
        EXPECT_TRUE(daemon->wait_for_log(slow)) << daemon->log();
        const std::uint64_t dropped = status(client).record().dropped();
        EXPECT_GT(dropped, 0U);
        while (status(client).record().dropped() == dropped) {
        }
        EXPECT_TRUE(client.record(""));
        const v1::RecordStatus end = status(client).record();
        EXPECT_EQ(end.error(), "");
        EXPECT_GT(end.frames(), 0U);
        EXPECT_EQ(daemon->log().find(slow), daemon->log().rfind(slow)) << daemon->log();
        daemon->send_signal(SIGTERM);
        EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
    }
    const auto replay =
        start(config_text(folder_.path() + "/slow.mkv"), {"--exit-at-end", "--set", "source.pace=fastest"});
    EXPECT_EQ(replay->wait_for_exit(std::chrono::seconds(60)), 0) << replay->log();
}

}  // namespace
}  // namespace disparityd::test
