// SPDX-License-Identifier: Apache-2.0
//
// The program beside a real daemon, which is killed and started again.
#include <csignal>

#include <gmock/gmock.h>

#include "tests/bridges/decoded_frame.h"
#include "tests/bridges/udp_listener.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using Wanted = std::function<bool(const DecodedFrame& frame)>;

class MavlinkRestartTest : public DaemonTest {
protected:
    std::string with_scan() const {
        return config_text("scene:vga@30?width=320&height=176&loop=8", 160, 88, "[scan]\nenabled = true\n");
    }

    std::optional<DecodedFrame> wait_for(const Wanted& wanted) {
        const auto deadline = std::chrono::steady_clock::now() + UdpListener::patience;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto bytes = listener_.receive();
            const auto frame = bytes ? decode(*bytes) : std::nullopt;
            EXPECT_TRUE(frame);
            if (!frame || wanted(*frame)) {
                return frame;
            }
        }
        return std::nullopt;
    }

    static bool is_scan(const DecodedFrame& frame) { return frame.id == 330; }

    static Wanted is_state(std::uint64_t state) {
        return [state](const DecodedFrame& frame) { return frame.id == 0 && frame.number(7, 1) == state; };
    }

    std::unique_ptr<DaemonProcess> start_bridge(std::vector<std::string> source) {
        std::vector<std::string> arguments{"--udp", listener_.address(), "--max-age-ms", "2000"};
        arguments.insert(arguments.end(), source.begin(), source.end());
        return std::make_unique<DaemonProcess>(folder_, arguments, DaemonProcess::Environment{}, DISPARITY_MAVLINK);
    }

    /// The bridge starts without a daemon, sends scans of one, says that it was killed, and sends those of the next
    /// one.
    void expect_survival(const std::vector<std::string>& source) {
        const auto bridge = start_bridge(source);
        EXPECT_TRUE(wait_for(is_state(1))) << bridge->log();
        auto daemon = start_ready(with_scan());
        EXPECT_TRUE(wait_for(is_scan)) << bridge->log() << daemon->log();
        daemon->send_signal(SIGKILL);
        EXPECT_EQ(daemon->wait_for_exit(), 128 + SIGKILL);
        EXPECT_TRUE(wait_for(is_state(5))) << bridge->log();
        const auto next = wait_for([](const DecodedFrame&) { return true; });
        ASSERT_TRUE(next);
        EXPECT_EQ(next->id, 0U) << "nothing but HEARTBEAT without a daemon";
        daemon = start_ready(with_scan());
        EXPECT_TRUE(wait_for(is_scan)) << bridge->log() << daemon->log();
        EXPECT_TRUE(wait_for(is_state(4))) << bridge->log();
        bridge->send_signal(SIGTERM);
        EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
        EXPECT_THAT(bridge->log(), testing::HasSubstr("frames are synthetic"));
    }

    UdpListener listener_;
};

TEST_F(MavlinkRestartTest, OverSharedMemory) {
    expect_survival({"--name", shared_memory_name()});
}

TEST_F(MavlinkRestartTest, OverASocket) {
    expect_survival({"--socket", "unix:" + folder_.path() + "/d.sock"});
}

TEST_F(MavlinkRestartTest, ADaemonWithoutScanIsSaidOverBoth) {
    const auto over_memory = start_bridge({"--name", shared_memory_name()});
    const auto over_socket = start_bridge({"--socket", "unix:" + folder_.path() + "/d.sock"});
    const auto daemon = start_ready(config_text());
    EXPECT_TRUE(over_memory->wait_for_log("set [scan] enabled = true")) << over_memory->log();
    EXPECT_TRUE(over_socket->wait_for_log("set [scan] enabled = true")) << over_socket->log();
}

}  // namespace
}  // namespace disparityd::test
