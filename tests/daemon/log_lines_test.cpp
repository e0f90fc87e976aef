// SPDX-License-Identifier: Apache-2.0
//
// What clients can make the real daemon write into its log.
#include <chrono>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

class LogLinesTest : public DaemonTest {
protected:
    static std::ptrdiff_t lines_with(const DaemonProcess& daemon, const std::string& text) {
        std::istringstream log(daemon.log());
        std::ptrdiff_t count = 0;
        for (std::string line; std::getline(log, line);) {
            count += line.find(text) != std::string::npos ? 1 : 0;
        }
        return count;
    }
};

TEST_F(LogLinesTest, OnlyClientsThatSubscribeAreTold) {
    const auto daemon = start_ready(config_text());
    for (int i = 0; i < 20; ++i) {
        WireClient passer_by(daemon->address(i % 2 == 0 ? "unix:" : "tcp:"));
        passer_by.hello("passes by");
        status(passer_by);
    }
    {
        WireClient stays = subscriber(daemon->address("unix:"), {v1::DISPARITY}, "stays");
        ASSERT_TRUE(stays.receive_frame());
    }
    ASSERT_TRUE(daemon->wait_for_log("(stays, unix): left")) << daemon->log();
    EXPECT_EQ(lines_with(*daemon, "(stays, unix): subscribed"), 1) << daemon->log();
    EXPECT_EQ(lines_with(*daemon, "passes by"), 0) << daemon->log();
    EXPECT_EQ(lines_with(*daemon, "client "), 2) << daemon->log();
}

TEST_F(LogLinesTest, AtTheLevelDebugAllAreTold) {
    const auto daemon = start_ready(config_text(), {"--set", "log.level=debug"});
    {
        WireClient passer_by(daemon->address("unix:"));
        passer_by.hello("passes by");
    }
    EXPECT_TRUE(daemon->wait_for_log("(passes by, unix): connected")) << daemon->log();
    EXPECT_TRUE(daemon->wait_for_log("(passes by, unix): left")) << daemon->log();
}

TEST_F(LogLinesTest, RecordingsInALoopFloodNeitherLogNorFolder) {
    const auto daemon = start_ready(config_text());
    WireClient client(daemon->address("unix:"));
    client.hello();
    const auto begin = std::chrono::steady_clock::now();
    int granted = 0;
    for (int i = 0; i < 150; ++i) {
        granted += client.record("flood" + std::to_string(i) + ".mkv") ? 1 : 0;
        client.record("");
    }
    const auto seconds = std::chrono::ceil<std::chrono::seconds>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_LE(granted, 6 + seconds);
    EXPECT_LE(lines_with(*daemon, "recording"), 60 + 4 * seconds)
        << "mostly the refusals, which have a limit of their own";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
        files += entry.path().extension() == ".mkv" ? 1 : 0;
    }
    EXPECT_LE(files, granted);
}

}  // namespace
}  // namespace disparityd::test
