// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/scan_source.h"

#include <deque>
#include <functional>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>

#include "tests/bridges/scan_frames.h"

namespace disparityd::mavlink {
namespace {

using disparity::Frame;
using disparity::ReadResult;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;
using testing::HasSubstr;

/// Reads what the test has prepared, then nothing new.
class PreparedSource : public ScanSource {
public:
    std::deque<std::function<ReadResult(Frame&)>> reads;

    void add(const Frame& frame) {
        reads.emplace_back([frame](Frame& out) {
            out = frame;
            return ReadResult::frame;
        });
    }

private:
    ReadResult read(Frame& frame, milliseconds /*timeout*/) override {
        if (reads.empty()) {
            return ReadResult::timeout;
        }
        const auto read = std::move(reads.front());
        reads.pop_front();
        return read(frame);
    }
    std::string why_gone() const override { return "it has gone"; }
};

double distance_of(const std::optional<TimedScan>& timed) {
    return timed ? timed->scan.sectors.at(0).distance_m : -1;
}

TEST(ScanSource, ReturnsTheScanOfAFrame) {
    PreparedSource source;
    source.add(test::client_frame(test::scan_with_obstacle(0, 1234), {}));
    const auto timed = source.next(milliseconds(0));
    EXPECT_EQ(distance_of(timed), 1.234);
    EXPECT_FALSE(timed->synthetic);
    EXPECT_EQ(source.problem(), "");
    EXPECT_FALSE(source.next(milliseconds(0)));
    EXPECT_EQ(source.problem(), "");
}

TEST(ScanSource, TakesTheAgeThatTheClientTells) {
    PreparedSource source;
    const auto before = steady_clock::now();
    source.add(test::client_frame(test::scan_with_obstacle(0, 1000), seconds(2)));
    const auto timed = source.next(milliseconds(0));
    ASSERT_TRUE(timed);
    EXPECT_GE(timed->captured, before - seconds(2));
    EXPECT_LE(timed->captured, steady_clock::now() - seconds(2));
}

TEST(ScanSource, AnAgeBelowZeroIsNone) {
    PreparedSource source;
    source.add(test::client_frame(test::scan_with_obstacle(0, 1000), -seconds(1000)));
    const auto timed = source.next(milliseconds(0));
    ASSERT_TRUE(timed);
    EXPECT_LE(timed->captured, steady_clock::now());
}

TEST(ScanSource, SaysThatTheDaemonServesNoScan) {
    PreparedSource source;
    source.add(Frame{});
    EXPECT_FALSE(source.next(milliseconds(0)));
    EXPECT_THAT(source.problem(), HasSubstr("[scan] enabled = true"));
    source.add(test::client_frame(test::scan_with_obstacle(0, 1000), {}));
    EXPECT_TRUE(source.next(milliseconds(0)));
    EXPECT_EQ(source.problem(), "");
}

TEST(ScanSource, SaysWhyTheDaemonIsGone) {
    PreparedSource source;
    source.reads.emplace_back([](Frame&) { return ReadResult::gone; });
    EXPECT_FALSE(source.next(milliseconds(0)));
    EXPECT_EQ(source.problem(), "it has gone");
}

TEST(ScanSource, BeginsAnewAfterAnError) {
    PreparedSource source;
    source.reads.emplace_back([](Frame&) -> ReadResult { throw std::runtime_error("refused"); });
    source.add(test::client_frame({1, 2, 3}, {}));  // no scan
    source.add(test::client_frame(test::scan_with_obstacle(0, 1000), {}));
    EXPECT_FALSE(source.next(milliseconds(0)));
    EXPECT_EQ(source.problem(), "refused");
    EXPECT_FALSE(source.next(milliseconds(0))) << "it waits before it tries again";
    EXPECT_EQ(source.reads.size(), 2U);
    source.reads.pop_front();
    const auto deadline = steady_clock::now() + seconds(60);
    std::optional<TimedScan> timed;
    while (!timed && steady_clock::now() < deadline) {
        timed = source.next(milliseconds(10));
    }
    EXPECT_EQ(distance_of(timed), 1);
}

TEST(ScanSource, SaysWhatIsWrongWithAScan) {
    PreparedSource source;
    source.add(test::client_frame({1, 2, 3}, {}));
    EXPECT_FALSE(source.next(milliseconds(0)));
    EXPECT_THAT(source.problem(), HasSubstr("3 bytes"));
}

TEST(ScanSource, RefusesNamesThatCanBeNone) {
    EXPECT_THROW(ScanSource("a b", {}, 10), std::invalid_argument);
    EXPECT_THROW(ScanSource("tcp:somewhere", {}, 10), std::invalid_argument);
    EXPECT_NO_THROW(ScanSource("nobody-serves-this", {}, 10));
    EXPECT_NO_THROW(ScanSource("unix:/nobody/serves/this", {}, 10));
}

}  // namespace
}  // namespace disparityd::mavlink
