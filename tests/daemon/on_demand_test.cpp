// SPDX-License-Identifier: Apache-2.0
//
// [pipeline] on_demand of the real daemon: who wakes it, who does not, and what its status says meanwhile.
#include <csignal>

#include <gmock/gmock.h>

#include "clients/cpp/disparity_client.hpp"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

class OnDemandTest : public DaemonTest {
protected:
    std::string config() const { return on_demand(config_text("scene:vga@60?width=320&height=176&loop=8")); }

    static std::string on_demand(std::string config) {
        const std::string before = "workers = 1\n";
        return config.insert(config.find(before) + before.size(), "on_demand = true\n");
    }

    /// A client that subscribes to nothing.
    static WireClient observer(const DaemonProcess& daemon) {
        WireClient client(daemon.address("unix:"));
        client.hello("observer");
        return client;
    }

    /// Its status once some more frames have come that nobody wanted, and none that was wanted is still on its way.
    static v1::Status idle_status(WireClient& observer) {
        const std::uint64_t before = status(observer).unwanted();
        v1::Status now = status(observer);
        while (now.state() != "idle" || now.unwanted() < before + 3 ||
               now.published() + now.dropped() + now.damaged() + now.unwanted() != now.captured()) {
            now = status(observer);
        }
        return now;
    }
};

TEST_F(OnDemandTest, WithoutAnybodyFramesAreCapturedAndNotMatched) {
    const auto daemon = start_ready(config());
    WireClient client = observer(*daemon);
    const v1::Status now = idle_status(client);
    EXPECT_EQ(now.published(), 0U) << "who asks for a status wants no frame";
    EXPECT_EQ(now.dropped(), 0U);
    EXPECT_EQ(now.unwanted(), now.captured());
    EXPECT_EQ(now.totals().unwanted(), now.unwanted());
    EXPECT_THAT(now.detail(), HasSubstr("nobody wants frames"));
    EXPECT_THAT(now.notices(), Not(Contains(HasSubstr("on_demand"))));
    daemon->send_signal(SIGINT);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
}

// Counted in frames: a frame may come between the subscription and the status, no second one is left out.
TEST_F(OnDemandTest, ASubscriptionGetsTheNextFrame) {
    const auto daemon = start_ready(config());
    WireClient other = observer(*daemon);
    idle_status(other);
    {
        WireClient client = observer(*daemon);
        ASSERT_TRUE(client.send(subscription({v1::DISPARITY})));
        v1::Envelope question;
        question.mutable_status_request();
        ASSERT_TRUE(client.send(question));
        std::optional<std::uint64_t> unwanted;
        bool frame_came = false;
        while (!unwanted || !frame_came) {
            const auto message = client.receive();
            ASSERT_TRUE(message) << daemon->log();
            frame_came = frame_came || message->envelope.has_frame();
            if (message->envelope.has_status()) {
                unwanted = message->envelope.status().unwanted();
            }
        }
        const v1::Status now = status(client);
        EXPECT_LE(now.unwanted(), *unwanted + 1);
        EXPECT_EQ(now.state(), "running") << now.detail();
    }
    const v1::Status after = idle_status(other);
    EXPECT_GE(after.published(), 1U);
    EXPECT_EQ(idle_status(other).published(), after.published());
}

TEST_F(OnDemandTest, AReaderOfSharedMemoryGetsNewFrames) {
    const auto daemon = start_ready(config());
    WireClient other = observer(*daemon);
    for (const std::chrono::milliseconds patience : {std::chrono::milliseconds(DaemonProcess::patience), 0ms}) {
        const v1::Status before = idle_status(other);
        disparity::SharedMemoryReader memory(shared_memory_name());
        disparity::Frame frame;
        for (int i = 0; i < 3; ++i) {
            disparity::ReadResult result = memory.read(frame, patience);
            while (patience == 0ms && result == disparity::ReadResult::timeout) {  // it never waits
                result = memory.read(frame, patience);
            }
            ASSERT_EQ(result, disparity::ReadResult::frame) << daemon->log();
            EXPECT_GE(frame.sequence + 1, before.captured()) << "a frame of the round before";
        }
        EXPECT_EQ(status(other).state(), "running");
    }
}

TEST_F(OnDemandTest, ARecordingWantsFrames) {
    const auto daemon = start_ready(config());
    WireClient client = observer(*daemon);
    idle_status(client);
    ASSERT_TRUE(client.record("a.mkv"));
    while (status(client).published() < 3) {
    }
    EXPECT_EQ(status(client).state(), "running");
    EXPECT_TRUE(client.record(""));
    const std::uint64_t published = idle_status(client).published();
    EXPECT_EQ(idle_status(client).published(), published);
}

TEST_F(OnDemandTest, AReloadSwitchesItOnAndOff) {
    const auto daemon = start_ready(config_text());
    WireClient client = observer(*daemon);
    while (status(client).published() < 3) {
    }
    EXPECT_EQ(status(client).state(), "running");
    EXPECT_EQ(status(client).unwanted(), 0U) << "it is off unless asked for";
    folder_.write("d.toml", config());
    daemon->send_signal(SIGHUP);
    idle_status(client);
    folder_.write("d.toml", config_text());
    daemon->send_signal(SIGHUP);
    v1::Status now = status(client);
    while (now.state() != "running" || now.published() < 3) {
        now = status(client);
    }
    EXPECT_EQ(now.unwanted(), 0U);
    EXPECT_GT(now.totals().unwanted(), 0U);
}

TEST_F(OnDemandTest, OfAReplayEveryFrameIsMatched) {
    const std::vector<std::string> replay{"--set", "source.policy=replay"};
    {
        const auto daemon = start_ready(config(), replay);
        WireClient client = observer(*daemon);
        while (status(client).published() < 10) {
        }
        const v1::Status now = status(client);
        EXPECT_EQ(now.unwanted(), 0U);
        EXPECT_THAT(now.notices(), Contains(HasSubstr("on_demand has no effect")));
    }
    const auto check = start(config(), {"--check", replay[0], replay[1]});
    EXPECT_TRUE(check->wait_for_line([](const std::string& line) {
        return line.find("on_demand has no effect") != std::string::npos;
    })) << check->log();
}

// The only frame of a folder: who comes later than it would never get one.
TEST_F(OnDemandTest, ThePictureOfAReplayWaitsForItsFirstClient) {
    std::string image = "P5\n96 64\n255\n";
    for (int i = 0; i < 96 * 64; ++i) {
        image.push_back(static_cast<char>(i * i % 251));
    }
    folder_.write("im2.pgm", image);
    folder_.write("im6.pgm", image);
    const auto daemon = start_ready(config_text(folder_.path(), 96, 64), {"--set", "source.start=on-client"});
    WireClient other = observer(*daemon);
    v1::Status now = status(other);
    while (now.detail().find("[source] start") == std::string::npos) {  // until it is open
        now = status(other);
    }
    EXPECT_EQ(now.state(), "waiting");
    EXPECT_EQ(now.captured(), 0U) << "who asks for a status wants no frame";
    WireClient client = subscriber(daemon->address("unix:"), {v1::DISPARITY});
    const auto frame = client.receive_frame();
    ASSERT_TRUE(frame) << daemon->log();
    EXPECT_EQ(frame->envelope.frame().publish_index(), 0U);
    EXPECT_EQ(frame->envelope.frame().sequence(), 0U);
    while (now.state() != "ended") {
        now = status(other);
    }
    EXPECT_EQ(now.published(), 1U);
    daemon->send_signal(SIGHUP);  // it plays again, for whoever is there
    EXPECT_TRUE(client.receive_frame()) << daemon->log();
}

TEST_F(OnDemandTest, AReplayThatWaitsForAClientStopsAtOnce) {
    folder_.write("im2.pgm", "P5\n96 64\n255\n" + std::string(96 * 64, 'x'));
    folder_.write("im6.pgm", "P5\n96 64\n255\n" + std::string(96 * 64, 'x'));
    const auto daemon = start_ready(config_text(folder_.path(), 96, 64), {"--set", "source.start=on-client"});
    daemon->send_signal(SIGINT);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
}

TEST_F(OnDemandTest, FramesOfALiveSourceWaitForNobody) {
    const auto daemon = start(config(), {"--set", "source.start=on-client"});
    EXPECT_EQ(daemon->wait_for_exit(), 2);
    EXPECT_THAT(daemon->log(), HasSubstr("[source] start is \"on-client\", but the frames of scene:"));
}

}  // namespace
}  // namespace disparityd::test
