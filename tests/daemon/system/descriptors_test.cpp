// SPDX-License-Identifier: Apache-2.0
//
// Clients never take the descriptors that the daemon needs for itself.
#include <csignal>
#include <cstring>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

class DescriptorsTest : public DaemonTest {
protected:
    void SetUp() override {
        if (std::strlen(DISPARITYD_EMULATOR) > 0) {
            GTEST_SKIP() << "the limit would be the emulator's";
        }
    }

    /// A daemon that the shell has given these limits.
    std::unique_ptr<DaemonProcess> start_with(int soft, int hard, int max_clients) {
        const std::string limits =
            "ulimit -Sn " + std::to_string(soft) + " && ulimit -Hn " + std::to_string(hard) + " && exec \"$@\"";
        auto daemon = std::make_unique<DaemonProcess>(
            folder_,
            std::vector<std::string>{"-c", limits, "sh", DISPARITYD_PROGRAM, "--print-address", "--config",
                                     folder_.write("d.toml", config_text()), "--set",
                                     "socket.max_clients=" + std::to_string(max_clients), "--set",
                                     "socket.idle_timeout_s=0"},
            DaemonProcess::Environment{}, "/bin/sh");
        EXPECT_TRUE(daemon->wait_until_ready()) << daemon->log();
        return daemon;
    }

    /// As many as asked for: those that were welcomed.
    static std::vector<WireClient> crowd(const std::string& address, int count) {
        std::vector<WireClient> welcomed;
        for (int i = 0; i < count; ++i) {
            const auto begin = std::chrono::steady_clock::now();
            WireClient client(address);
            const auto answer = client.hello();
            if (answer && answer->has_welcome()) {
                welcomed.push_back(std::move(client));
            } else if (std::chrono::steady_clock::now() - begin > 5s) {
                break;  // nobody accepts it; the next ones would wait as long
            }
        }
        return welcomed;
    }

    /// What takes descriptors: a recording, and a reload with both sources open.
    void expect_all_else_works(const DaemonProcess& daemon, WireClient& client) {
        EXPECT_TRUE(client.record("a.mkv")) << daemon.log();
        folder_.write("d.toml", config_text(scene, 96, 64));
        daemon.send_signal(SIGHUP);
        const auto end = std::chrono::steady_clock::now() + 60s;
        while (status(client).geometry().width() != 96 && std::chrono::steady_clock::now() < end) {
            ASSERT_EQ(daemon.log().find("nothing is changed"), std::string::npos) << daemon.log();
        }
        ASSERT_TRUE(client.send(subscription({v1::DISPARITY})));
        EXPECT_TRUE(client.receive_frame()) << daemon.log();
        EXPECT_EQ(daemon.log().find("Too many open files"), std::string::npos) << daemon.log();
    }
};

TEST_F(DescriptorsTest, TheSoftLimitIsRaised) {
    const auto daemon = start_with(64, 1000, 200);
    std::vector<WireClient> clients = crowd(daemon->address("unix:"), 200);
    ASSERT_EQ(clients.size(), 200U) << daemon->log();
    expect_all_else_works(*daemon, clients.back());
    EXPECT_THAT(status(clients.front()).notices(), Not(Contains(HasSubstr("clients are served"))));
}

TEST_F(DescriptorsTest, FewerClientsAreServedWhereTheHardLimitIsLow) {
    const auto daemon = start_with(200, 200, 1024);
    EXPECT_TRUE(daemon->wait_for_log("at most 56 clients are served")) << daemon->log();
    std::vector<WireClient> clients = crowd(daemon->address("unix:"), 220);
    ASSERT_EQ(clients.size(), 56U) << daemon->log();
    EXPECT_THAT(status(clients.front()).notices(), Contains(HasSubstr("at most 56 clients are served")));
    expect_all_else_works(*daemon, clients.back());
    EXPECT_THAT(status(clients.front()).notices(), Contains(HasSubstr("at most 56 clients are served")));
}

}  // namespace
}  // namespace disparityd::test
