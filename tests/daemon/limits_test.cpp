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
