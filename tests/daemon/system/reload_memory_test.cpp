// SPDX-License-Identifier: Apache-2.0
//
// What reloads and clients that have gone leave in the daemon's memory.
#include <algorithm>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

class ReloadMemoryTest : public DaemonTest {
protected:
    /// Of the daemon's own, without files and shared memory, MiB.
    static double memory_mib(const DaemonProcess& daemon) {
        std::ifstream status("/proc/" + std::to_string(daemon.pid()) + "/status");
        for (std::string line; std::getline(status, line);) {
            if (line.starts_with("RssAnon:")) {
                return std::stod(line.substr(8)) / 1024;
            }
        }
        return 0;
    }

    static std::size_t count(const std::string& text, const std::string& word) {
        std::size_t found = 0;
        for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
            ++found;
        }
        return found;
    }

    /// Reloads so often, each time until the new engine serves; the most memory that one of them left.
    static double reload(DaemonProcess& daemon, int times) {
        double most = 0;
        for (int i = 0; i < times; ++i) {
            const std::size_t before = count(daemon.log(), "serving scene");
            daemon.send_signal(SIGHUP);
            const auto deadline = std::chrono::steady_clock::now() + 60s;
            while (count(daemon.log(), "serving scene") == before && std::chrono::steady_clock::now() < deadline) {
                std::this_thread::sleep_for(5ms);
            }
            EXPECT_GT(count(daemon.log(), "serving scene"), before) << daemon.log();
            WireClient client = subscriber(daemon.address("unix:"), {v1::DISPARITY});
            EXPECT_TRUE(client.receive_frame()) << "all of the new engine's memory is in use";
            most = std::max(most, memory_mib(daemon));
        }
        return most;
    }
};

TEST_F(ReloadMemoryTest, ManyReloadsTakeNoMoreThanFew) {
    const auto daemon = start_ready(config_text("scene:vga@30?loop=2", 672, 376));
    const double few = reload(*daemon, 3);
    const double many = reload(*daemon, 15);
    RecordProperty("few_mib", static_cast<int>(few));
    RecordProperty("many_mib", static_cast<int>(many));
    EXPECT_LT(many, few * 1.25) << few << " MiB after 3 reloads, " << many << " MiB after 18";
}

}  // namespace
}  // namespace disparityd::test
