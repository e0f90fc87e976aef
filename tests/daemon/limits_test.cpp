// SPDX-License-Identifier: Apache-2.0
//
// The real daemon at the limits that an administrator sets for it: of memory and of the size of a file.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

class LimitsTest : public DaemonTest {
protected:
    static void limit(const DaemonProcess& daemon, __rlimit_resource what, rlim_t most) {
        const rlimit limits{most, most};
        ASSERT_EQ(::prlimit(daemon.pid(), what, &limits, nullptr), 0);
    }

    static rlim_t address_space(const DaemonProcess& daemon) {
        std::ifstream status("/proc/" + std::to_string(daemon.pid()) + "/status");
        for (std::string line; std::getline(status, line);) {
            if (line.starts_with("VmSize:")) {
                return static_cast<rlim_t>(std::stoull(line.substr(7))) * 1024;
            }
        }
        return 0;
    }
};

TEST_F(LimitsTest, ADaemonThatFindsNoMemoryEndsWithOneLine) {
    // Each client that does not read holds its part of a frame. What the C library has reserved for its heaps counts as
    // used.
    constexpr std::uint32_t parts_of_all_heaps = 300;
    std::string config = config_text(scene, 640, 352);
    config.replace(config.find("[socket]\n"), 9, "[socket]\nmax_clients = 400\n");
    auto daemon = start_ready(config);
    const std::string address = daemon->address("unix:");
    limit(*daemon, RLIMIT_AS, address_space(*daemon) + (12U << 20U));
    std::vector<WireClient> clients;
    for (std::uint32_t i = 0; i < parts_of_all_heaps && !daemon->wait_for_exit(0ms); ++i) {
        v1::Envelope wanted = subscription({v1::DISPARITY, v1::LEFT});
        v1::Region& region = *wanted.mutable_subscribe()->mutable_region();
        region.set_x(1 + i % 30);
        region.set_y(i / 30);
        region.set_width(600);
        region.set_height(300);
        try {
            clients.emplace_back(address);
            clients.back().hello();
            clients.back().send(wanted);
        } catch (const std::runtime_error&) {
            break;  // it has ended
        }
    }
    EXPECT_EQ(daemon->wait_for_exit(), 1) << daemon->log();
    EXPECT_THAT(daemon->log(), testing::EndsWith("MemoryMax= of a service)\n"));
    EXPECT_THAT(daemon->log(), HasSubstr("disparityd: error: out of memory: "));
    EXPECT_THAT(daemon->log(), testing::Not(HasSubstr("bad_alloc")));
}

/// Connects, asks for a part of the frame that no other client has, the next one compressed behind it, for a trace and
/// for statuses, and begins one more message. Reads none of it.
WireClient client_that_reads_nothing(const std::string& address, std::uint32_t number) {
    WireClient client(address);
    client.hello();
    v1::Envelope wanted =
        subscription({v1::DISPARITY, v1::CONFIDENCE, v1::LEFT, v1::RIGHT, v1::LEFT_COLOUR, v1::RIGHT_COLOUR});
    wanted.mutable_subscribe()->set_encoding(v1::ZSTD);
    v1::Region& region = *wanted.mutable_subscribe()->mutable_region();
    region.set_x(number);
    region.set_width(640);
    region.set_height(376);
    client.send(wanted);
    v1::Envelope trace;
    trace.mutable_trace_request()->set_seconds(0.1);
    client.send(trace);
    v1::Envelope status;
    status.mutable_status_request();
    for (int i = 0; i < 30; ++i) {
        client.send(status);
    }
    std::vector<std::uint8_t> message(4 + 65000);
    message[0] = 0x00;
    message[2] = 0x01;  // 65536 bytes are announced
    client.send_bytes(message);
    return client;
}

/// Returns the number before " MB" behind this word.
double megabytes_behind(const std::string& text, const std::string& word) {
    const auto at = text.find(word);
    return at == std::string::npos ? 0 : std::stod(text.substr(at + word.size()));
}

TEST_F(LimitsTest, ClientsThatReadNothingTakeNoMoreThanWasStated) {
    if (!std::string(DISPARITYD_EMULATOR).empty()) {
        GTEST_SKIP() << "the memory would be the emulator's";
    }
    constexpr std::uint32_t clients = 24;
    const std::string config = config_text("scene:vga@15?loop=8", 672, 376);
    const std::vector<std::string> more{"--set", "rectify.right=true",
                                        "--set", "rectify.colour=true",
                                        "--set", "socket.max_clients=" + std::to_string(clients)};
    auto daemon = start_ready(config, more);
    ASSERT_TRUE(daemon->wait_for_log("memory at most: ")) << daemon->log();
    const double engine = megabytes_behind(daemon->log(), ": matching ");
    const double frames = megabytes_behind(daemon->log(), ", frames ");
    const double of_clients = megabytes_behind(daemon->log(), "that read nothing ");
    const double before = daemon->peak_memory_mib();
    std::vector<WireClient> held;
    const auto number_of = [&] { return static_cast<std::uint32_t>(held.size()); };
    while (number_of() < clients - 1) {
        held.push_back(
            client_that_reads_nothing(daemon->address(number_of() % 2 == 0 ? "tcp:" : "unix:"), number_of()));
    }
    WireClient good = subscriber(daemon->address("unix:"), {v1::DISPARITY}, "good");
    // As long as anything more is sent to them, they do not yet hold all that they can.
    std::uint64_t sent = 0;
    for (int unchanged = 0; unchanged < 10;) {
        ASSERT_TRUE(good.receive_frame()) << daemon->log();
        std::uint64_t now_sent = 0;
        const v1::Status now = status(good);
        for (const v1::ClientStatus& client : now.clients()) {
            now_sent += client.name() == "good" ? 0 : client.frames_sent();
        }
        unchanged = now_sent == sent && sent >= held.size() ? unchanged + 1 : 0;
        sent = now_sent;
    }
    constexpr double mb_of_mib = 1.048576;
    const double peak = daemon->peak_memory_mib();
    RecordProperty("grown_by_mb", std::to_string((peak - before) * mb_of_mib));
    RecordProperty("stated_mb", std::to_string(of_clients));
    EXPECT_LT(peak * mb_of_mib, engine + frames + of_clients) << daemon->log();
    EXPECT_GT((peak - before) * mb_of_mib, of_clients / 10) << "they do hold something";
}

TEST_F(LimitsTest, AFileThatMayNotGrowIsAFullDisk) {
    auto daemon = start_ready(config_text());
    limit(*daemon, RLIMIT_FSIZE, 400'000);
    WireClient recording = subscriber(daemon->address("unix:"), {});
    ASSERT_TRUE(recording.record("limited.mkv"));
    WireClient client = subscriber(daemon->address("unix:"), {v1::DISPARITY});
    ASSERT_TRUE(daemon->wait_for_log("limited.mkv finished: ")) << daemon->log();
    EXPECT_THAT(daemon->log(), HasSubstr("File too large"));
    EXPECT_TRUE(client.receive_frame()) << "frames go on";
    EXPECT_EQ(status(client).state(), "running");
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
}

}  // namespace
}  // namespace disparityd::test
