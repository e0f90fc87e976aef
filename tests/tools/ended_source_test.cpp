// SPDX-License-Identifier: Apache-2.0
//
// Shared memory still has the last frame of a source that has ended: its age is told, however long ago that was.
#include <optional>
#include <regex>

#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/disparity_file.h"

namespace disparityd::test {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

/// A daemon whose source has ended. It listens where its name says, so that tools find its socket by the name alone.
class EndedSourceTest : public FolderTest {
protected:
    /// Settings of the daemon, and how tools reach it.
    virtual std::vector<std::string> settings() const { return {}; }
    virtual std::vector<std::string> reach() const { return {"--name", name_}; }

    void SetUp() override {
        FolderTest::SetUp();
        name_ = "dctl-ended-" + std::to_string(getpid());
        std::vector<std::string> arguments{"--source", "scene:vga@30?width=128&height=96&loop=8&frames=8",
                                           "--name",   name_,
                                           "--set",    "socket.tcp=",
                                           "--set",    "match.disparities=16"};
        for (const std::string& setting : settings()) {
            arguments.insert(arguments.end(), {"--set", setting});
        }
        started_ = steady_clock::now();
        daemon_ = std::make_unique<Program>(DISPARITYD, arguments);
        ASSERT_TRUE(eventually([this] {
            const Outcome outcome = ctl("status", {"--json"});
            return !daemon_->running() ||
                   (outcome.exit_code == 0 && nlohmann::json::parse(outcome.out)["state"] == "ended");
        }));
        ASSERT_TRUE(daemon_->running()) << daemon_->wait().err;
        ended_ = steady_clock::now();
    }

    void TearDown() override {
        if (daemon_ && daemon_->running()) {
            daemon_->send(SIGTERM);
            daemon_->wait();
        }
        FolderTest::TearDown();
    }

    Outcome ctl(const std::string& command, std::vector<std::string> arguments) const {
        const std::vector<std::string> daemon = reach();
        arguments.insert(arguments.begin(), daemon.begin(), daemon.end());
        arguments.insert(arguments.begin(), command);
        return run(DISPARITYCTL, arguments);
    }

    steady_clock::time_point started_;  ///< before the first frame was captured
    steady_clock::time_point ended_;    ///< after the last one was published
    std::string name_;
    std::unique_ptr<Program> daemon_;
};

/// Returns the age that snapshot tells on standard error; nothing where it tells none.
std::optional<double> told_age_s(const std::string& text) {
    std::smatch match;
    const std::regex line("disparityctl: the source has ended: its last frame is written, which is ([0-9.]+) s old\n");
    return std::regex_match(text, match, line) ? std::optional(std::stod(match[1])) : std::nullopt;
}

double seconds_since(steady_clock::time_point since) {
    return duration<double>(steady_clock::now() - since).count();
}

TEST_F(EndedSourceTest, SnapshotTellsHowOldTheLastFrameIs) {
    constexpr double rounding_s = 0.06;  // one decimal is told
    double least_s = 0;
    Outcome outcome;
    // A frame of less than a second is written without a word: that is what the daemon sees now, as far as one can say.
    ASSERT_TRUE(eventually([&] {
        least_s = seconds_since(ended_);
        outcome = ctl("snapshot", {"--disparity", path("last.pfm")});
        return outcome.exit_code != 0 || !outcome.err.empty();
    }));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(images::read_disparity_pfm(path("last.pfm")).width, 128);
    const std::optional<double> first = told_age_s(outcome.err);
    ASSERT_TRUE(first) << outcome.err;
    EXPECT_GE(*first, std::max(least_s, 1.0) - rounding_s);
    EXPECT_LE(*first, seconds_since(started_) + rounding_s);

    const double later_s = seconds_since(ended_) + 0.5;
    ASSERT_TRUE(eventually([&] { return seconds_since(ended_) >= later_s; }));
    const std::optional<double> second = told_age_s(ctl("snapshot", {"--disparity", path("last.pfm")}).err);
    ASSERT_TRUE(second);
    EXPECT_GE(*second, later_s - rounding_s) << "it grows with the time";
    EXPECT_LE(*second, seconds_since(started_) + rounding_s);
}

TEST_F(EndedSourceTest, AClientsFirstReadTellsTheAge) {
    std::int64_t sent_age_ns = 0;
    for (int i = 0; i < 2; ++i) {
        disparity::SharedMemoryReader reader(name_);
        disparity::Frame frame;
        const double least_s = seconds_since(ended_);
        ASSERT_EQ(reader.read(frame, std::chrono::milliseconds(0)), disparity::ReadResult::frame);
        EXPECT_LE(static_cast<double>(frame.age_ns) / 1e9, seconds_since(started_));
        EXPECT_GE(static_cast<double>(frame.age_ns - frame.sent_age_ns) / 1e9, least_s) << "published before the end";
        EXPECT_GE(frame.sent_age_ns, 0);
        if (i == 0) {
            sent_age_ns = frame.sent_age_ns;
            ASSERT_TRUE(eventually([&] { return seconds_since(ended_) > least_s + 0.2; }));
        } else {
            EXPECT_EQ(frame.sent_age_ns, sent_age_ns) << "the same frame";
        }
        EXPECT_EQ(reader.read(frame, std::chrono::milliseconds(0)), disparity::ReadResult::timeout) << "once";
    }
}

/// The socket alone holds no frame from before.
class EndedSourceOverTheSocketTest : public EndedSourceTest {
protected:
    std::vector<std::string> settings() const override { return {"socket.unix=/tmp/" + name_ + ".sock"}; }
    std::vector<std::string> reach() const override { return {"--socket", "unix:/tmp/" + name_ + ".sock"}; }
};

TEST_F(EndedSourceOverTheSocketTest, SnapshotSaysWhyNoFrameComes) {
    const Outcome outcome = ctl("snapshot", {"--disparity", path("last.pfm"), "--timeout", "1"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, testing::ContainsRegex("no frame came within 1 s: the source has ended after [1-8] "
                                                    "frames?; reload to play it again"));
    EXPECT_FALSE(std::filesystem::exists(path("last.pfm")));
}

}  // namespace
}  // namespace disparityd::test
