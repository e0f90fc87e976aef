// SPDX-License-Identifier: Apache-2.0
//
// `disparityctl scan` beside real daemons: with and without scans, ended, stopped, hanging, started again.
#include <algorithm>
#include <cstdio>
#include <sstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ShowScansTest : public FolderTest {
protected:
    ShowScansTest()
        : socket_("/tmp/dctl-scan-" + std::to_string(getpid()) + ".sock"),
          name_("dctl-scan-" + std::to_string(getpid())) {}

    void start(const std::vector<std::string>& settings, const std::string& more = {}) {
        std::vector<std::string> words{"--source", "scene:vga@15?" + size_ + "&loop=8" + more, "--name", name_};
        std::vector<std::string> set{"socket.unix=" + socket_, "socket.tcp=", "match.disparities=32"};
        set.insert(set.end(), settings.begin(), settings.end());
        for (const std::string& setting : set) {
            words.insert(words.end(), {"--set", setting});
        }
        daemon_.reset();
        daemon_ = std::make_unique<Program>(DISPARITYD, words);
        ASSERT_TRUE(eventually([this] { return !daemon_->running() || published() > 0; }));
        ASSERT_TRUE(daemon_->running()) << daemon_->wait().err;
    }

    void TearDown() override {
        if (daemon_ && daemon_->running()) {
            daemon_->send(SIGTERM);
            daemon_->wait();
        }
        FolderTest::TearDown();
    }

    nlohmann::json status() const {
        const Outcome outcome = run(DISPARITYCTL, {"status", "--json", "--socket", "unix:" + socket_});
        return outcome.exit_code == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json{{"published", 0}};
    }
    int published() const { return status()["published"].get<int>(); }

    enum class Way { memory, socket };
    std::vector<std::string> arguments(Way way, std::vector<std::string> more) const {
        more.insert(more.begin(), {"scan", "--name", name_});
        if (way == Way::socket) {
            more.insert(more.end(), {"--socket", "unix:" + socket_});
        }
        return more;
    }

    /// Runs it until it has said something, then ends it by Ctrl-C.
    Outcome run_until(const std::vector<std::string>& words, const std::string& said) const {
        Program program(DISPARITYCTL, words);
        EXPECT_TRUE(eventually([&] { return !program.running() || program.said(said); }));
        program.send(SIGINT);
        return program.wait();
    }

    /// A daemon that ends in order, then one that is killed; another one comes after each.
    void find_again(Way way) {
        for (const int signal : {SIGTERM, SIGKILL}) {
            start({"scan.enabled=true", "scan.max_m=20"});
            Program program(DISPARITYCTL, arguments(way, {"--json"}));
            ASSERT_TRUE(eventually([&] { return !program.running() || program.said("\"max_m\":20.0"); }));
            daemon_->send(signal);
            daemon_->wait();
            // On a busy machine it may have been silent for so long before that it counts as hung.
            ASSERT_TRUE(eventually([&] { return !program.running() || program.said("; waiting for it"); }));
            start({"scan.enabled=true", "scan.max_m=9"});
            ASSERT_TRUE(eventually([&] { return !program.running() || program.said("\"max_m\":9.0"); }));
            program.send(SIGINT);
            EXPECT_EQ(program.wait().exit_code, 0);
        }
    }

    std::string size_ = "width=160&height=120";  ///< of an eye
    std::string socket_;
    std::string name_;
    std::unique_ptr<Program> daemon_;
};

const std::vector<std::string> scans{"scan.enabled=true", "scan.sectors=12"};

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

TEST_F(ShowScansTest, JsonComesBothWays) {
    start(scans);
    for (const Way way : {Way::memory, Way::socket}) {
        const Outcome outcome = run_until(arguments(way, {"--json"}), "sectors");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        int seen = 0;
        for (const std::string& line : lines_of(outcome.out)) {
            const auto json = nlohmann::json::parse(line);
            if (json["sequence"].is_null()) {
                continue;  // a busy machine
            }
            ++seen;
            EXPECT_EQ(json["sectors"].size(), 12U);
            EXPECT_EQ(json["calibrated"], true);
            EXPECT_EQ(json["synthetic"], true);
            EXPECT_GT(json["age_ms"], 0);
            EXPECT_EQ(json["max_m"], 20);
            EXPECT_NEAR(json["free"].get<double>() + json["occupied"].get<double>() + json["unknown"].get<double>(), 1,
                        1e-9);
        }
        EXPECT_GT(seen, 0);
    }
}

TEST_F(ShowScansTest, LinesAreTheDefaultWithoutATerminal) {
    start(scans);
    const Outcome outcome = run(DISPARITYCTL, arguments(Way::socket, {"--count", "3"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto lines = lines_of(outcome.out);
    ASSERT_EQ(lines.size(), 4U);
    EXPECT_THAT(lines[0], HasSubstr("nearest"));
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_THAT(lines[i], testing::AnyOf(HasSubstr("synthetic"), HasSubstr("no scan: ")));
    }
}

TEST_F(ShowScansTest, APlotWithoutATerminalMovesNoCursor) {
    start(scans);
    const Outcome outcome = run_until(arguments(Way::memory, {"--plot", "--ascii", "--range", "7"}), "synthetic");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("ground "), HasSubstr(" 7 m"), HasSubstr("^"), Not(HasSubstr("\033"))));
    for (const std::string& line : lines_of(outcome.out)) {
        EXPECT_LT(line.size(), 80U);
        EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; })) << line;
    }
}

TEST_F(ShowScansTest, ADaemonWithoutScansIsRefused) {
    start({});
    for (const Way way : {Way::memory, Way::socket}) {
        const Outcome outcome = run(DISPARITYCTL, arguments(way, {"--json"}));
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_THAT(outcome.err, AllOf(testing::StartsWith("disparityctl: error: "),
                                       HasSubstr("set [scan] enabled = true in its configuration")));
        EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    }
}

TEST_F(ShowScansTest, AReloadThatEndsTheScansIsTold) {
    write_text(path("on.toml"), "[scan]\nenabled = true\n");
    const std::vector<std::string> words{"--config", path("on.toml"), "--source", "scene:vga@15?width=160&height=120",
                                         "--name",   name_,           "--set",    "socket.unix=" + socket_,
                                         "--set",    "socket.tcp="};
    daemon_ = std::make_unique<Program>(DISPARITYD, words);
    ASSERT_TRUE(eventually([this] { return !daemon_->running() || published() > 0; }));
    for (const Way way : {Way::memory, Way::socket}) {
        write_text(path("on.toml"), "[scan]\nenabled = true\n");
        daemon_->send(SIGHUP);
        ASSERT_TRUE(eventually([&] {
            return run(DISPARITYCTL, arguments(way, {"--json", "--count", "1"})).out.find("sectors") !=
                   std::string::npos;
        }));
        Program program(DISPARITYCTL, arguments(way, {"--json"}));
        ASSERT_TRUE(eventually([&] { return !program.running() || program.said("sectors"); }));
        ASSERT_TRUE(program.running());
        write_text(path("on.toml"), "[scan]\nenabled = false\n");
        daemon_->send(SIGHUP);
        const Outcome outcome = program.wait();
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_THAT(outcome.err, HasSubstr("set [scan] enabled = true")) << outcome.err;
    }
}

TEST_F(ShowScansTest, ADaemonThatWasAwayIsFoundAgainInMemory) {
    find_again(Way::memory);
}

TEST_F(ShowScansTest, ADaemonThatWasAwayIsFoundAgainAtItsSocket) {
    find_again(Way::socket);
}

/// `disparityctl scan --json`, its words quoted for a shell.
std::string json_in_a_shell(const std::string& name, const std::string& more) {
    return std::string("'") + DISPARITYCTL + "' scan --json --name '" + name + "' " + more;
}

TEST_F(ShowScansTest, AProgramThatWorksOnEachScanReadsNoOldOnes) {
    start({"scan.enabled=true"});
    const std::string slow = "while IFS= read -r line; do printf '%s\\n' \"$line\"; sleep 0.4; done";
    const Outcome outcome = run("/bin/sh", {"-c", json_in_a_shell(name_, "--count 7") + " | { " + slow + "; }"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::vector<std::uint64_t> sequences;
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) {
        const auto json = nlohmann::json::parse(line);
        ASSERT_TRUE(json.contains("sequence")) << line;
        sequences.push_back(json["sequence"].get<std::uint64_t>());
    }
    ASSERT_EQ(sequences.size(), 7U);
    // The second one waits in the pipe while the first one is worked on; 15 come in a second.
    for (std::size_t i = 2; i < sequences.size(); ++i) {
        EXPECT_GE(sequences[i], sequences[i - 1] + 3) << i;
    }
}

TEST_F(ShowScansTest, CtrlCEndsItWhereNobodyReads) {
    start({"scan.enabled=true"});
    const std::string name = path("pipe");
    ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
    const int pipe = ::open(name.c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(pipe, 0);
    const int size = ::fcntl(pipe, F_SETPIPE_SZ, 4096);  // less than a line
    ASSERT_GT(size, 0);
    Program program("/bin/sh", {"-c", "exec " + json_in_a_shell(name_, ">'" + name + "'")});
    int unread = 0;
    EXPECT_TRUE(eventually([&] { return ::ioctl(pipe, FIONREAD, &unread) == 0 && unread == size; })) << unread;
    program.send(SIGINT);
    EXPECT_TRUE(eventually([&] { return !program.running(); }));
    ::close(pipe);
    EXPECT_EQ(program.wait().exit_code, 0);
}

TEST_F(ShowScansTest, APlotSaysThatADaemonHangs) {
    start(scans);
    for (const Way way : {Way::memory, Way::socket}) {
        Program program(DISPARITYCTL, arguments(way, {"--plot"}));
        ASSERT_TRUE(eventually([&] { return !program.running() || program.said("synthetic"); }));
        daemon_->send(SIGSTOP);
        EXPECT_TRUE(eventually([&] { return !program.running() || program.said("NO SCAN for"); }));
        daemon_->send(SIGCONT);
        program.send(SIGINT);
        EXPECT_EQ(program.wait().exit_code, 0);
    }
}

TEST_F(ShowScansTest, NoScanFromBeforeIsShown) {
    start(scans, "&frames=8");
    ASSERT_TRUE(eventually([this] { return status()["state"] == "ended"; }));
    for (const Way way : {Way::memory, Way::socket}) {
        const Outcome outcome = run(DISPARITYCTL, arguments(way, {"--json", "--count", "1"}));
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const auto json = nlohmann::json::parse(outcome.out);
        EXPECT_TRUE(json["sequence"].is_null()) << outcome.out;
        if (way == Way::socket) {  // else the tool knows no socket to ask at
            EXPECT_THAT(json["why"].get<std::string>(), HasSubstr("the source has ended"));
        }
    }
}

// The rendered floor lies 1.15 m below the camera and is tilted by 1.7 and 2.3 degrees.
TEST_F(ShowScansTest, PrintsTheMountingThatTheFloorShows) {
    size_ = "width=320&height=240";
    start({"scan.enabled=true"});
    Outcome outcome;
    // The program waits for 30 s, in which a sanitizer on a busy machine sees too few frames.
    ASSERT_TRUE(eventually([&] {
        outcome = run(DISPARITYCTL, arguments(Way::socket, {"--mounting"}));
        return outcome.exit_code == 0 || outcome.err.find("no mounting was found") == std::string::npos;
    }));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    double height = 0;
    double pitch = 0;
    double roll = 0;
    ASSERT_EQ(std::sscanf(outcome.out.c_str(), "[scan] camera_height_m = %lf pitch_deg = %lf roll_deg = %lf", &height,
                          &pitch, &roll),
              3)
        << outcome.out;
    EXPECT_NEAR(height, 1.15, 0.15);
    EXPECT_NEAR(pitch, 1.7, 2.5);
    EXPECT_NEAR(roll, -2.3, 2.5);
    EXPECT_THAT(status()["notices"].dump(), HasSubstr("the floor contradicts the camera's mounting"));
}

}  // namespace
}  // namespace disparityd::test
