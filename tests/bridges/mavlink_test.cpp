// SPDX-License-Identifier: Apache-2.0
//
// The program beside a daemon that the test plays.
#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>

#include "tests/bridges/decoded_frame.h"
#include "tests/bridges/scan_frames.h"
#include "tests/bridges/terminal_pair.h"
#include "tests/bridges/udp_listener.h"
#include "tests/daemon/daemon_process.h"
#include "tests/proto/fake_daemon.h"

namespace disparityd::test {
namespace {

using mavlink::unknown_cm;
using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;
using testing::HasSubstr;

class MavlinkTest : public ::testing::Test {
protected:
    ~MavlinkTest() override { done_ = true; }

    /// Starts a daemon that sends such a scan again and again, to the end of the test.
    void serve(const std::vector<std::uint8_t>& scan, std::chrono::nanoseconds age) {
        daemon_ = std::make_unique<FakeDaemon>([this, scan, message = frame_message(scan, age)](ServerEnd& client) {
            client.greet();
            v1::Envelope subscribe;
            if (!client.receive(subscribe)) {
                return;
            }
            EXPECT_EQ(subscribe.subscribe().products_size(), 1);
            EXPECT_EQ(subscribe.subscribe().products(0), v1::SCAN);
            while (!done_) {
                client.send(message, scan);
                std::this_thread::sleep_for(milliseconds(10));  // the pace of a camera
            }
        });
    }

    std::unique_ptr<DaemonProcess> start(std::vector<std::string> arguments) {
        std::signal(SIGINT, SIG_DFL);  // a shell's background job inherits that it is ignored
        return std::make_unique<DaemonProcess>(folder_, std::move(arguments), DaemonProcess::Environment{},
                                               DISPARITY_MAVLINK);
    }

    /// The next frame that `wanted` takes.
    std::optional<DecodedFrame> wait_for(const std::function<bool(const DecodedFrame&)>& wanted) {
        const auto deadline = steady_clock::now() + UdpListener::patience;
        while (steady_clock::now() < deadline) {
            const auto bytes = listener_.receive();
            if (!bytes) {
                break;
            }
            const auto frame = decode(*bytes);
            EXPECT_TRUE(frame) << "a datagram is one frame";
            if (frame && wanted(*frame)) {
                return frame;
            }
        }
        return std::nullopt;
    }

    std::optional<DecodedFrame> wait_for(std::uint32_t id) {
        return wait_for([id](const DecodedFrame& frame) { return frame.id == id; });
    }

    std::optional<DecodedFrame> wait_for_state(std::uint64_t state) {
        return wait_for([state](const DecodedFrame& frame) { return frame.id == 0 && frame.number(7, 1) == state; });
    }

    TemporaryFolder folder_;
    UdpListener listener_;
    std::atomic<bool> done_{false};
    std::atomic<int> connections_{0};
    std::unique_ptr<FakeDaemon> daemon_;
};

TEST_F(MavlinkTest, SendsScansOverUdpUntilItIsStopped) {
    serve(scan_with_obstacle(10, 1239), {});
    const auto bridge = start({"--socket", daemon_->tcp_address(), "--udp", listener_.address(), "--system-id", "42",
                               "--max-age-ms", "2000"});
    const auto scan = wait_for(330);
    ASSERT_TRUE(scan) << bridge->log();
    EXPECT_EQ(scan->system, 42);
    EXPECT_EQ(scan->component, 196);
    EXPECT_EQ(scan->distances()[70], 123);
    EXPECT_EQ(scan->distances()[0], unknown_cm);
    EXPECT_EQ(scan->number(154, 2), 800U);
    EXPECT_TRUE(wait_for_state(4)) << bridge->log();
    for (int i = 0; i < 10; ++i) {
        listener_.answer(std::vector<std::uint8_t>(1000, 0xfd));  // it parses nothing of this
    }
    EXPECT_TRUE(wait_for(330)) << bridge->log();
    bridge->send_signal(SIGTERM);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
    EXPECT_THAT(bridge->log(), HasSubstr("disparity-mavlink: note: scans are sent to udp 127.0.0.1:"));
}

TEST_F(MavlinkTest, SendsNothingButHeartbeatsOfOldScans) {
    serve(scan_with_obstacle(10, 1239), seconds(5));
    const auto bridge =
        start({"--socket", daemon_->unix_address(), "--udp", listener_.address(), "--max-age-ms", "2000"});
    EXPECT_TRUE(bridge->wait_for_log("ms old, allowed: 2000 ms")) << bridge->log();
    for (int heartbeats = 0; heartbeats < 3; ++heartbeats) {
        const auto frame = wait_for([](const DecodedFrame&) { return true; });
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->id, 0U);
        EXPECT_EQ(frame->number(7, 1), 1U);
    }
}

TEST_F(MavlinkTest, SaysWhatADaemonWithoutScanLacksAndTriesAgain) {
    daemon_ = std::make_unique<FakeDaemon>([this](ServerEnd& client) {
        ++connections_;
        client.greet();
        v1::Envelope subscribe;
        client.receive(subscribe);
        v1::Envelope answer;
        answer.mutable_error()->set_message("product SCAN is not served");
        client.send(answer);
        while (client.receive(subscribe)) {
        }
    });
    const auto bridge = start({"--socket", daemon_->unix_address(), "--udp", listener_.address()});
    EXPECT_TRUE(bridge->wait_for_log("no scan: ")) << bridge->log();
    EXPECT_TRUE(bridge->wait_for_log("product SCAN is not served; where it serves no scan, set")) << bridge->log();
    const auto deadline = steady_clock::now() + seconds(60);
    while (connections_ < 3 && steady_clock::now() < deadline) {
        std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_GE(connections_, 3);
    EXPECT_TRUE(wait_for_state(1)) << "it lives";
    bridge->send_signal(SIGINT);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
}

/// Reads the serial line until an OBSTACLE_DISTANCE_3D has come.
std::vector<DecodedFrame> read_until_3d(TerminalPair& terminal) {
    std::vector<std::uint8_t> stream;
    std::vector<DecodedFrame> frames;
    const auto deadline = steady_clock::now() + seconds(60);
    while ((frames.empty() || frames.back().id != 11037) && steady_clock::now() < deadline && terminal.read(stream)) {
        for (const DecodedFrame& frame : take_frames(stream)) {
            frames.push_back(frame);
            if (frame.id == 11037) {
                break;
            }
        }
    }
    return frames;
}

TEST_F(MavlinkTest, SendsScansOverASerialLineThatIsUnpluggedAndPluggedIn) {
    serve(scan_with_obstacle(-90, 2000), {});
    const std::string device = folder_.file("tty");
    auto terminal = std::make_unique<TerminalPair>();
    std::filesystem::create_symlink(terminal->path(), device);
    const auto bridge =
        start({"--socket", daemon_->unix_address(), "--serial", device + ":921600", "--3d", "--max-age-ms", "2000"});
    const auto frames = read_until_3d(*terminal);
    ASSERT_GE(frames.size(), 3U) << bridge->log();
    EXPECT_EQ(frames.back().id, 11037U) << bridge->log();
    EXPECT_NEAR(frames.back().real(8), 2, 1e-5) << "y, to the right";
    EXPECT_EQ(frames[frames.size() - 2].id, 330U);
    EXPECT_EQ(frames[frames.size() - 2].distances()[18], 200);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].sequence, i % 256) << "none is missing";
    }

    terminal.reset();
    EXPECT_TRUE(bridge->wait_for_log("serial " + device + ":921600: ")) << bridge->log();
    std::filesystem::remove(device);
    TerminalPair another;
    std::filesystem::create_symlink(another.path(), device);
    EXPECT_GE(read_until_3d(another).size(), 2U) << bridge->log();
    bridge->send_signal(SIGTERM);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
}

TEST_F(MavlinkTest, EndsInOrderWithoutDaemonAndLink) {
    const auto bridge = start({"--name", "nobody-serves-this", "--serial", "/dev/no-such-device:57600"});
    EXPECT_TRUE(bridge->wait_for_log("serial /dev/no-such-device:57600: No such file or directory")) << bridge->log();
    EXPECT_TRUE(bridge->wait_for_log("no scan: ")) << bridge->log();
    bridge->send_signal(SIGINT);
    EXPECT_EQ(bridge->wait_for_exit(), 0) << bridge->log();
}

TEST_F(MavlinkTest, RefusesArgumentsInOneLine) {
    const std::string to = listener_.address();
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
        {{}, "found no autopilot, expected --udp HOST:PORT or --serial DEVICE:BAUD"},
        {{"--udp", to, "--serial", "/dev/tty:57600"}, "--serial"},
        {{"--udp", "14550"}, "--udp: found \"14550\", expected HOST:PORT"},
        {{"--udp", "host:0"}, "found port 0, allowed: 1 .. 65535"},
        {{"--udp", "host:-1"}, "expected HOST:PORT"},
        {{"--serial", "/dev/tty"}, "expected DEVICE:BAUD"},
        {{"--serial", "/dev/tty:57601"}, "found 57601 baud, allowed: 9600, "},
        {{"--udp", to, "--name", "a/b"}, "--name: found 'a/b', allowed: 1 to 64 characters"},
        {{"--udp", to, "--socket", "b"}, "--socket: found 'b', allowed: tcp:HOST:PORT"},
        {{"--udp", to, "--rate", "nan"}, "--rate: found nan, allowed: 0.1 .. 100"},
        {{"--udp", to, "--system-id", "0"}, "--system-id: found 0, allowed: 1 .. 255"},
        {{"--udp", to, "--max-age-ms", "5000"}, "--max-age-ms: found 5000, allowed: 10 .. 2000"},
        {{"--udp", to, "--min-distance-m", "8"}, "--min-distance-m: found 8, allowed: less than --max-distance-m"},
        {{"--udp", to, "--min-distance-m", "0.001"}, "--min-distance-m: found 0.001, allowed: 0.01 .. 100"},
        {{"--udp", to, "--min-distance-m", "0.3", "--max-distance-m", "0.5", "--rate", "0"}, "--rate: found 0"},
        {{"--udp", to, "--nonsense"}, "--nonsense"}};
    for (const auto& [arguments, text] : cases) {
        const auto bridge = start(arguments);
        EXPECT_EQ(bridge->wait_for_exit(), 2) << text;
        const std::string log = bridge->log();
        EXPECT_THAT(log, HasSubstr("disparity-mavlink: error: "));
        EXPECT_THAT(log, HasSubstr(text));
        EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
    }
}

}  // namespace
}  // namespace disparityd::test
