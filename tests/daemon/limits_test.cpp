// SPDX-License-Identifier: Apache-2.0
//
// The real daemon at the limits that an administrator sets for it: of memory and of the size of a file.
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

    /// A message of 1 MiB, all but its last byte; false when the daemon has closed before.
    static bool send_unfinished(WireClient& client) {
        std::vector<std::uint8_t> bytes((1U << 20U) + 3, 0x55);
        bytes[0] = bytes[1] = bytes[3] = 0;
        bytes[2] = 0x10;
        return client.send_bytes(bytes);
    }
};

TEST_F(LimitsTest, ClientsThatUseUpTheMemoryEndNoDaemon) {
    // What the C library has reserved for its heaps counts as used: 64 MiB for each.
    constexpr int more_than_a_heap = 150;
    std::string config = config_text();
    config.replace(config.find("[socket]\n"), 9, "[socket]\nmax_clients = 300\n");
    auto daemon = start_ready(config);
    const std::string address = daemon->address("unix:");
    {
        WireClient before = subscriber(address, {v1::DISPARITY});
        ASSERT_TRUE(before.receive_frame());
        limit(*daemon, RLIMIT_AS, address_space(*daemon) + (12U << 20U));
        std::vector<WireClient> clients;
        for (int i = 0; i < more_than_a_heap; ++i) {
            clients.emplace_back(address);
            send_unfinished(clients.back());
        }
        EXPECT_TRUE(daemon->wait_for_log("memory to go on with it") || daemon->wait_for_log("not enough memory", 0ms))
            << daemon->log();
    }
    EXPECT_FALSE(daemon->wait_for_exit(0ms)) << daemon->log();
    WireClient after = subscriber(address, {v1::DISPARITY});
    EXPECT_TRUE(after.receive_frame()) << daemon->log();
    EXPECT_EQ(status(after).state(), "running");
    EXPECT_THAT(daemon->log(), testing::Not(HasSubstr("bad_alloc")));
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
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
