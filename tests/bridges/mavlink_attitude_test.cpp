// SPDX-License-Identifier: Apache-2.0
//
// The program between a real daemon and an autopilot that the test plays.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

#include "proto/scan.h"
#include "tests/bridges/attitude_frame.h"
#include "tests/bridges/decoded_frame.h"
#include "tests/bridges/udp_listener.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

constexpr float pitch = 15 * std::numbers::pi_v<float> / 180;

/// A scan as it came.
struct ReadScan {
    proto::ScanHead head{};
    std::vector<proto::ScanSector> sectors;

    bool unknown() const {
        return std::all_of(sectors.begin(), sectors.end(),
                           [](const proto::ScanSector& sector) { return sector == proto::ScanSector{}; });
    }
    int nearest_mm() const {
        int nearest = std::numeric_limits<int>::max();
        for (const proto::ScanSector& sector : sectors) {
            if (sector.state == proto::SectorState::occupied) {
                nearest = std::min<int>(nearest, sector.distance_mm);
            }
        }
        return nearest;
    }
};

class MavlinkAttitudeTest : public DaemonTest {
protected:
    /// The camera of the scene is level. So on a vehicle that holds it 15 degrees down, the nose is 15 degrees up.
    void start_flying(const std::string& ground) {
        daemon_ = start_ready(config_text("scene:vga@30?width=320&height=176&loop=8", 320, 176,
                                          "[scan]\nenabled = true\ncamera_height_m = 0.0\nlow_m = -0.3\nhigh_m = 0.3\n"
                                          "max_m = 8.0\npitch_deg = 15.0\nground = \"" +
                                              ground + "\"\n"));
        reader_ = std::make_unique<WireClient>(subscriber(unix_address(), {v1::SCAN}));
    }
    std::string unix_address() const { return "unix:" + folder_.path() + "/d.sock"; }
    void start_bridge() {
        bridge_ = std::make_unique<DaemonProcess>(
            folder_, std::vector<std::string>{"--udp", autopilot_.address(), "--socket", unix_address(), "--attitude"},
            DaemonProcess::Environment{}, DISPARITY_MAVLINK);
    }

    /// Sends that attitude, if any, until such a scan comes.
    std::optional<ReadScan> wait_for(const std::optional<std::pair<float, float>>& attitude,
                                     const std::function<bool(const ReadScan& scan)>& wanted) {
        const auto deadline = std::chrono::steady_clock::now() + UdpListener::patience;
        while (std::chrono::steady_clock::now() < deadline) {
            if (attitude) {
                autopilot_.answer(attitude_frame(1, 1, attitude->first, attitude->second));
            }
            const auto message = reader_->receive_frame();
            if (!message) {
                break;
            }
            ReadScan scan;
            std::memcpy(&scan.head, message->payload.data(), sizeof scan.head);
            scan.sectors.resize(scan.head.sectors);
            std::memcpy(scan.sectors.data(), message->payload.data() + sizeof scan.head,
                        scan.sectors.size() * sizeof(proto::ScanSector));
            if (wanted(scan)) {
                return scan;
            }
        }
        return std::nullopt;
    }

    /// The daemon's answer to a level.
    v1::Envelope give(WireClient& client, std::vector<v1::LevelSample> samples) {
        v1::Envelope request;
        request.mutable_give_level();
        for (const v1::LevelSample& sample : samples) {
            *request.mutable_give_level()->add_samples() = sample;
        }
        EXPECT_TRUE(client.send(request));
        const auto answer = client.receive();
        EXPECT_TRUE(answer);
        return answer ? answer->envelope : v1::Envelope();
    }
    static v1::LevelSample sample(double ahead, double left, double up, std::uint32_t age_us = 0) {
        v1::LevelSample sample;
        sample.set_ahead(ahead);
        sample.set_left(left);
        sample.set_up(up);
        sample.set_age_us(age_us);
        return sample;
    }
    WireClient client(const std::string& address) {
        WireClient client(address);
        EXPECT_TRUE(client.hello());
        return client;
    }

    UdpListener autopilot_;
    std::unique_ptr<DaemonProcess> daemon_;
    std::unique_ptr<DaemonProcess> bridge_;
    std::unique_ptr<WireClient> reader_;
};

bool is_level(const ReadScan& scan) {
    return scan.head.ground == proto::GroundSource::autopilot;
}

TEST_F(MavlinkAttitudeTest, AScanIsLevelAsLongAsTheAutopilotTellsItsAttitude) {
    start_flying("autopilot");
    EXPECT_TRUE(wait_for({}, [](const ReadScan& scan) { return scan.unknown(); }));
    start_bridge();
    bool asked = false;
    while (!asked) {  // it is asked for what it does not tell
        const auto bytes = autopilot_.receive();
        ASSERT_TRUE(bytes) << bridge_->log();
        const auto frame = decode(*bytes);
        ASSERT_TRUE(frame);
        asked = frame->id == 76 && frame->number(28, 2) == 511 && frame->real(0) == 30;
    }
    const auto level = wait_for(std::pair(0.0F, pitch), is_level);
    ASSERT_TRUE(level) << bridge_->log() << daemon_->log();
    EXPECT_NEAR(level->head.ground_slope_ahead, -10000 * std::tan(pitch), 2);
    EXPECT_NEAR(level->head.ground_slope_left, 0, 1);
    EXPECT_LT(level->nearest_mm(), 3200) << "what is ahead at the camera's height is an obstacle";
    WireClient other = client(unix_address());
    const v1::Status now = status(other);
    EXPECT_EQ(now.level().source(), "autopilot");
    EXPECT_GT(now.level().age_ms(), 0);
    EXPECT_THAT(give(other, {sample(0, 0, 1)}).error().message(), HasSubstr("level: another client gives it"));

    // Silence, and what is no number, are no level.
    EXPECT_TRUE(wait_for({}, [](const ReadScan& scan) { return scan.unknown() && !is_level(scan); }));
    EXPECT_TRUE(wait_for(std::pair(0.0F, pitch), is_level));
    EXPECT_TRUE(wait_for(std::pair(std::nanf(""), pitch),
                         [](const ReadScan& scan) { return scan.unknown() && !is_level(scan); }));
    EXPECT_EQ(status(other).level().source(), "");
}

TEST_F(MavlinkAttitudeTest, OnlyWhoMayControlTellsIt) {
    start_flying("autopilot");
    WireClient tcp = client(daemon_->address("tcp:"));
    EXPECT_THAT(give(tcp, {sample(0, 0, 1)}).error().message(), HasSubstr("level: refused over TCP"));
    EXPECT_TRUE(wait_for({}, [](const ReadScan& scan) { return scan.unknown(); }));
}

TEST_F(MavlinkAttitudeTest, WhatIsNoLevelIsRefusedAsAWhole) {
    start_flying("autopilot");
    WireClient local = client(unix_address());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [&](const std::vector<v1::LevelSample>& samples) {
        return give(local, samples).error().message();
    };
    EXPECT_THAT(refused({}), HasSubstr("found 0 samples, allowed: 1 to 64"));
    EXPECT_THAT(refused(std::vector<v1::LevelSample>(65, sample(0, 0, 1))), HasSubstr("found 65 samples"));
    EXPECT_THAT(refused({sample(0, 0, 1), sample(nan, 0, 1)}), HasSubstr("allowed: a direction of length 1"));
    EXPECT_THAT(refused({sample(0, 0, 9)}), HasSubstr("allowed: a direction of length 1"));
    EXPECT_THAT(refused({sample(0, 0, 1, 1000001)}), HasSubstr("found an age of 1000001 us, allowed: at most 1000000"));
    EXPECT_EQ(status(local).level().age_ms(), 0) << "nothing was taken";
    const v1::Envelope taken = give(local, {sample(0, 0, 1, 3000)});
    ASSERT_TRUE(taken.has_level_status()) << taken.error().message();
    EXPECT_GE(taken.level_status().age_ms(), 3);
}

TEST_F(MavlinkAttitudeTest, OtherGroundsTakeNone) {
    start_flying("configured");
    WireClient local = client(unix_address());
    EXPECT_THAT(give(local, {sample(0, 0, 1)}).error().message(),
                HasSubstr("level: found ground = \"configured\", allowed: [scan] ground = \"autopilot\""));
    EXPECT_FALSE(status(local).has_level());
    start_bridge();
    autopilot_.receive();
    EXPECT_TRUE(wait_for(std::pair(0.0F, pitch), [this](const ReadScan& scan) {
        EXPECT_EQ(scan.head.ground, proto::GroundSource::configured);
        return bridge_->log().find("allowed: [scan] ground = \"autopilot\"") != std::string::npos;
    })) << bridge_->log();
}

}  // namespace
}  // namespace disparityd::test
