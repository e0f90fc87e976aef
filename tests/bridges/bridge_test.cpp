// SPDX-License-Identifier: Apache-2.0
//
// When the bridge sends what: with a source and a link that the test holds.
#include "bridges/mavlink/bridge.h"

#include <array>
#include <deque>

#include <boost/system/system_error.hpp>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bridges/mavlink/options.h"
#include "tests/bridges/decoded_frame.h"
#include "tests/bridges/scan_frames.h"

namespace disparityd::mavlink {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr seconds patience{60};

class HeldSource : public ScanSource {
public:
    std::deque<disparity::Frame> frames;
    bool gone = false;

    void add(int distance_mm, nanoseconds age = {}) {
        frames.push_back(test::client_frame(test::scan_with_obstacle(0, distance_mm), age));
    }

private:
    disparity::ReadResult read(disparity::Frame& frame, milliseconds /*timeout*/) override {
        if (frames.empty()) {
            return gone ? disparity::ReadResult::gone : disparity::ReadResult::timeout;
        }
        frame = frames.front();
        frames.pop_front();
        return disparity::ReadResult::frame;
    }
    std::string why_gone() const override { return "it has gone"; }
};

/// Keeps messages apart, as datagrams.
class HeldLink : public Link {
public:
    std::array<int, 2> ends{-1, -1};
    bool plugged = true;
    std::function<nanoseconds(std::size_t bytes)> needs = [](std::size_t) { return nanoseconds(0); };

    HeldLink() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0); }
    ~HeldLink() override {
        ::close(ends[0]);
        ::close(ends[1]);
    }

    std::vector<test::DecodedFrame> sent() {
        std::vector<test::DecodedFrame> frames;
        std::array<std::uint8_t, 512> bytes{};
        for (ssize_t got = 0; (got = ::recv(ends[1], bytes.data(), bytes.size(), 0)) > 0;) {
            const auto frame = test::decode(std::span(bytes).first(static_cast<std::size_t>(got)));
            EXPECT_TRUE(frame);
            frames.push_back(frame.value_or(test::DecodedFrame{}));
        }
        return frames;
    }

    nanoseconds time_for(std::size_t bytes) const override { return needs(bytes); }
    std::string name() const override { return "held"; }

private:
    void open_descriptor() override {
        if (!plugged) {
            throw boost::system::system_error(ENODEV, boost::system::system_category());
        }
    }
    void close_descriptor() override {}
    int descriptor() const override { return ends[0]; }
    bool outlives(int /*error*/) const override { return true; }
    std::string advice() const override { return "hold it"; }
};

class BridgeTest : public ::testing::Test {
protected:
    /// No scan is too old unless the test says so: machines may be slow.
    BridgeSettings settings_{.rate = 1000, .max_age = hours(1)};
    HeldSource source_;
    HeldLink link_;
    std::vector<std::string> lines_;
    Notes notes_{[this](const std::string& line) { lines_.push_back(line); }};
};

std::vector<std::uint32_t> ids(const std::vector<test::DecodedFrame>& frames) {
    std::vector<std::uint32_t> found;
    for (const auto& frame : frames) {
        found.push_back(frame.id);
    }
    return found;
}

std::uint64_t state(const test::DecodedFrame& heartbeat) {
    return heartbeat.number(7, 1);
}

TEST_F(BridgeTest, SendsHeartbeatsAndScans) {
    settings_.system_id = 42;
    settings_.component_id = 7;
    Bridge bridge(settings_, source_, link_, notes_);
    bridge.step();
    auto frames = link_.sent();
    ASSERT_EQ(ids(frames), (std::vector<std::uint32_t>{0}));
    EXPECT_EQ(state(frames[0]), 1U) << "boot";

    const auto before = Bridge::Clock::now();
    source_.add(1239);
    bridge.step();
    frames = link_.sent();
    ASSERT_THAT(ids(frames), Contains(330U));
    const test::DecodedFrame scan = frames.back();
    EXPECT_EQ(scan.id, 330U);
    EXPECT_EQ(scan.system, 42);
    EXPECT_EQ(scan.component, 7);
    EXPECT_EQ(scan.distances()[0], 123);
    EXPECT_EQ(scan.distances()[1], unknown_cm);
    const nanoseconds captured = std::chrono::microseconds(scan.number(0, 8));
    EXPECT_LE(captured, Bridge::Clock::now().time_since_epoch());
    EXPECT_GE(captured + seconds(60), before.time_since_epoch());
}

/// Gives scans until a HEARTBEAT says that they are sent.
bool becomes_active(Bridge& bridge, HeldSource& source, HeldLink& link) {
    const auto deadline = Bridge::Clock::now() + patience;
    while (Bridge::Clock::now() < deadline) {
        source.add(1000);
        bridge.step();
        for (const auto& frame : link.sent()) {
            if (frame.id == 0 && state(frame) == 4) {
                return true;
            }
        }
    }
    return false;
}

TEST_F(BridgeTest, TellsThatScansComeAndThatTheyNoLongerDo) {
    Bridge bridge(settings_, source_, link_, notes_);
    EXPECT_TRUE(becomes_active(bridge, source_, link_));
    source_.frames.clear();
    source_.gone = true;
    bridge.step();
    link_.sent();
    const auto deadline = Bridge::Clock::now() + patience;
    std::vector<test::DecodedFrame> frames;
    while ((frames.empty() || state(frames.back()) != 5) && Bridge::Clock::now() < deadline) {
        bridge.step();
        for (const auto& frame : link_.sent()) {
            EXPECT_EQ(frame.id, 0U) << "nothing but HEARTBEAT without a daemon";
            frames.push_back(frame);
        }
    }
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(state(frames.back()), 5U) << "critical";
    EXPECT_THAT(lines_, Contains("no scan: it has gone"));
    EXPECT_TRUE(becomes_active(bridge, source_, link_)) << "again";
}

TEST_F(BridgeTest, SendsNothingThatIsTooOld) {
    settings_.max_age = milliseconds(2000);
    Bridge bridge(settings_, source_, link_, notes_);
    for (int i = 0; i < 10; ++i) {
        source_.add(1000, seconds(5));
        bridge.step();
    }
    EXPECT_THAT(ids(link_.sent()), Not(Contains(330U)));
    EXPECT_THAT(lines_, Contains(testing::MatchesRegex("a scan is 5[0-9]* ms old, allowed: 2000 ms; .*")));
}

TEST_F(BridgeTest, CountsTheTimeOnTheLineAsAge) {
    settings_.send_3d = true;
    Bridge bridge(settings_, source_, link_, notes_);
    link_.needs = [](std::size_t bytes) { return bytes > 100 ? nanoseconds(0) : nanoseconds(hours(2)); };
    source_.add(1000);
    bridge.step();
    EXPECT_EQ(ids(link_.sent()), (std::vector<std::uint32_t>{0, 330})) << "no OBSTACLE_DISTANCE_3D";
    EXPECT_THAT(lines_, Contains(HasSubstr("not all messages leave in time")));
    link_.needs = [](std::size_t) { return nanoseconds(hours(2)); };
    source_.add(1000);
    bridge.step();
    EXPECT_THAT(ids(link_.sent()), Not(Contains(330U)));
}

TEST_F(BridgeTest, TellsAnotherStateAtOnce) {
    Bridge bridge(settings_, source_, link_, notes_);
    bridge.step();
    source_.add(1000);
    bridge.step();
    link_.sent();
    bridge.step();
    EXPECT_THAT(ids(link_.sent()), Contains(0U)) << "though the last HEARTBEAT was just sent";
}

TEST_F(BridgeTest, SendsNoMoreScansThanAllowed) {
    settings_.rate = 0.001;
    Bridge bridge(settings_, source_, link_, notes_);
    int scans = 0;
    for (int i = 0; i < 10; ++i) {
        source_.add(1000);
        bridge.step();
        for (const std::uint32_t id : ids(link_.sent())) {
            scans += id == 330 ? 1 : 0;
        }
    }
    EXPECT_EQ(scans, 1);
}

TEST_F(BridgeTest, ObstaclesIn3dDoNotKeepTheNextScanWaiting) {
    settings_.send_3d = true;
    settings_.rate = 10;
    Bridge bridge(settings_, source_, link_, notes_);
    link_.needs = [](std::size_t) { return milliseconds(101); };
    source_.add(1000);
    bridge.step();
    EXPECT_EQ(ids(link_.sent()), (std::vector<std::uint32_t>{0, 330}));
}

TEST_F(BridgeTest, SaysThatADaemonThatLivesSendsNothing) {
    Bridge bridge(settings_, source_, link_, notes_);
    const auto deadline = Bridge::Clock::now() + patience;
    while (lines_.size() < 2 && Bridge::Clock::now() < deadline) {
        bridge.step();
    }
    EXPECT_THAT(lines_, Contains(HasSubstr("no scan: the daemon lives")));
}

TEST_F(BridgeTest, SendsObstaclesIn3dWhenAsked) {
    settings_.send_3d = true;
    settings_.camera_height_m = 0.8;
    Bridge bridge(settings_, source_, link_, notes_);
    source_.add(2000);
    bridge.step();
    const auto frames = link_.sent();
    ASSERT_EQ(ids(frames), (std::vector<std::uint32_t>{0, 330, 11037}));
    EXPECT_EQ(frames[2].number(0, 4), frames[1].number(0, 8) / 1000) << "the same time";
    EXPECT_NEAR(frames[2].real(4), 2, 1e-5);
    EXPECT_NEAR(frames[2].real(12), 0.3, 1e-5);  // the obstacle reaches up to 0.5 m
}

TEST_F(BridgeTest, ALinkThatIsAwayIsSaidAndCostsNothing) {
    link_.plugged = false;
    Bridge bridge(settings_, source_, link_, notes_);
    for (int i = 0; i < 10; ++i) {
        source_.add(1000);
        bridge.step();
    }
    EXPECT_EQ(lines_, (std::vector<std::string>{"held: No such device; hold it"}));
    link_.plugged = true;
    const auto deadline = Bridge::Clock::now() + patience;
    std::vector<std::uint32_t> found;
    while (found.empty() && Bridge::Clock::now() < deadline) {
        source_.add(1000);
        bridge.step();
        found = ids(link_.sent());
    }
    EXPECT_THAT(found, Contains(330U));
    EXPECT_THAT(lines_, Contains("scans are sent to held"));
}

TEST_F(BridgeTest, SaysWhatAPersonShouldKnow) {
    settings_.limits.max_cm = 2500;
    Bridge bridge(settings_, source_, link_, notes_);
    source_.add(1000);
    source_.frames.back().flags = disparity::synthetic;
    bridge.step();
    EXPECT_THAT(lines_, Contains(HasSubstr("frames are synthetic")));
    EXPECT_THAT(lines_, Contains("the scan ends at 20.00 m, --max-distance-m is 25.00: no sector will be free; raise "
                                 "[scan] max_m of the daemon or lower --max-distance-m"));
}

TEST(Options, HiddenSpaceIsAnObstacleForWhoAsks) {
    Options options;
    EXPECT_FALSE(options.settings().limits.hidden_as_obstacle) << "ArduPilot would back away from it";
    options.hidden_as_obstacle = true;
    EXPECT_TRUE(options.settings().limits.hidden_as_obstacle);
}

}  // namespace
}  // namespace disparityd::mavlink
