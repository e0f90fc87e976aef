// SPDX-License-Identifier: Apache-2.0
//
// The programs that avoid obstacles brake when the daemon is stalled, killed or stopped, and go on by themselves.
#include <csignal>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/clients/avoid_programs.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

enum class Way { memory, socket };

void PrintTo(Way way, std::ostream* out) {
    *out << (way == Way::memory ? "shared memory" : "socket");
}

class AvoidDaemonTest : public DaemonTest, public ::testing::WithParamInterface<std::tuple<AvoidProgram, Way>> {
protected:
    void SetUp() override {
        const auto& [program, way] = GetParam();
        if (const std::string missing = program.missing(); !missing.empty()) {
            GTEST_SKIP() << missing;
        }
        if (program.python && way == Way::memory && !AVOID_PYTHON_LIBRARY) {
            GTEST_SKIP() << "an instrumented library cannot be loaded into a program that is not";
        }
    }

    /// A daemon whose scene is free for 2.7 m in a narrow corridor.
    std::unique_ptr<DaemonProcess> daemon(bool scan = true) {
        return start_ready(config(scan), {"--set", "match.method=sgm", "--set", "match.disparities=48"});
    }

    std::string config(bool scan) const {
        return config_text(scene, 320, 176,
                           std::string("[scan]\nenabled = ") + (scan ? "true" : "false") +
                               "\nsectors = 10\nfrom_deg = -15.0\nto_deg = 15.0\nhigh_m = 0.5\n");
    }

    /// The program with a limit of a second: a busy machine seldom needs as long for a frame, and where it does the
    /// program brakes and drives again before the next line that is waited for.
    std::unique_ptr<DaemonProcess> program() {
        const auto& [program, way] = GetParam();
        return program.start(
            folder_, {"--synthetic", "--width-m", "0.1", "--margin-m", "0.25", "--speed-mps", "0.1", "--max-age-ms",
                      "1000", way == Way::memory ? shared_memory_name() : "unix:" + folder_.path() + "/d.sock"});
    }

    static void expect_end(DaemonProcess& program, int signal) {
        program.send_signal(signal);
        EXPECT_TRUE(says(program, "BRAKE stopped by a signal"));
        EXPECT_EQ(program.wait_for_exit(), 0) << program.log();
        EXPECT_EQ(program.log(), "");
    }
};

TEST_P(AvoidDaemonTest, BrakesWithoutADaemonAndWaitsForIt) {
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "BRAKE no frame yet"));
    EXPECT_TRUE(says(*robot, "BRAKE no daemon: "));
    const auto served = daemon();
    EXPECT_TRUE(says(*robot, "DRIVE 0.10 m/s, free up to ")) << served->log();
    expect_end(*robot, SIGTERM);
}

TEST_P(AvoidDaemonTest, EndsWithoutADaemon) {
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "BRAKE no daemon: "));
    expect_end(*robot, SIGINT);
}

TEST_P(AvoidDaemonTest, BrakesWhileTheDaemonIsStalled) {
    const auto served = daemon();
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    served->send_signal(SIGSTOP);
    EXPECT_TRUE(says(*robot, "BRAKE frame is "));
    served->send_signal(SIGCONT);
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    expect_end(*robot, SIGTERM);
}

TEST_P(AvoidDaemonTest, BrakesWhenTheDaemonIsKilled) {
    auto served = daemon();
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    served->send_signal(SIGKILL);
    EXPECT_EQ(served->wait_for_exit(), 128 + SIGKILL);
    EXPECT_TRUE(says(*robot, "BRAKE no daemon: "));
    served = daemon();
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    expect_end(*robot, SIGINT);
}

TEST_P(AvoidDaemonTest, BrakesWhenTheDaemonIsStopped) {
    auto served = daemon();
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    served->send_signal(SIGTERM);
    EXPECT_EQ(served->wait_for_exit(), 0);
    EXPECT_TRUE(says(*robot, "BRAKE no daemon: "));
    served = daemon();
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    expect_end(*robot, SIGTERM);
}

TEST_P(AvoidDaemonTest, BrakesUntilTheDaemonMakesScans) {
    const auto served = daemon(false);
    const auto robot = program();
    EXPECT_TRUE(says(*robot, "BRAKE no scan: ")) << served->log();
    folder_.write("d.toml", config(true));
    served->send_signal(SIGHUP);
    EXPECT_TRUE(says(*robot, "DRIVE ")) << served->log();
    expect_end(*robot, SIGTERM);
}

INSTANTIATE_TEST_SUITE_P(Programs, AvoidDaemonTest,
                         ::testing::Combine(::testing::Values(AvoidProgram{false}, AvoidProgram{true}),
                                            ::testing::Values(Way::memory, Way::socket)),
                         [](const auto& made) {
                             return language_of(std::get<0>(made.param)) +
                                    (std::get<1>(made.param) == Way::memory ? "SharedMemory" : "Socket");
                         });

}  // namespace
}  // namespace disparityd::test
