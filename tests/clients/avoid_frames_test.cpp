// SPDX-License-Identifier: Apache-2.0
//
// The programs that avoid obstacles beside a daemon that sends what the test says: old frames, frames without a scan,
// nonsense. Limits of age are far longer than a slow machine needs, and old frames are far older.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "proto/scan.h"
#include "tests/clients/avoid_programs.h"
#include "tests/proto/fake_daemon.h"

namespace disparityd::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A message of the daemon. After the last one of a connection the daemon waits until the client leaves.
struct Said {
    v1::Envelope envelope;
    Bytes payload;
    bool last = false;
    std::int64_t late_ms = 0;  ///< a frame was sent so long ago
};

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

/// A daemon that sends what it is given, over one connection after the other.
class FedDaemon {
public:
    ~FedDaemon() { closed_ = true; }

    void feed(const Said& said) {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(said);
    }

    /// Says this frame, as often as the client is ready for one, whenever nothing else waits; nothing: none. A client
    /// may leave out one that was longer on its way than others.
    void repeat(const std::optional<Said>& frame) {
        const std::lock_guard lock(mutex_);
        repeated_ = frame;
    }

    std::string address() const { return daemon_.tcp_address(); }

    /// Returns the newest subscription.
    v1::Subscribe subscription() {
        const std::lock_guard lock(mutex_);
        return subscription_;
    }

private:
    /// What the client of a connection has said.
    struct Heard {
        bool subscribed = false;
        bool by_credit = false;
        std::uint32_t credit = 0;
    };

    /// Sends what it is given, a frame only when the client is ready for one.
    void serve(ServerEnd& end) {
        end.greet_with_clock();
        Heard heard;
        bool last = false;
        v1::Envelope message;
        while (!closed_) {
            if (end.hears(std::chrono::milliseconds(2))) {
                if (!end.receive(message)) {
                    return;
                }
                hear(end, message, heard);
                continue;
            }
            const auto said = last ? std::nullopt : next(heard.subscribed && (heard.credit > 0 || !heard.by_credit));
            if (said) {
                heard.credit -= said->envelope.has_frame() && heard.credit > 0 ? 1 : 0;
                last = said->last;
                end.send(said->envelope, said->payload);
            }
        }
    }

    void hear(ServerEnd& end, const v1::Envelope& message, Heard& heard) {
        if (message.has_subscribe()) {
            heard = {true, message.subscribe().by_credit(), 0};
            const std::lock_guard lock(mutex_);
            subscription_ = message.subscribe();
        } else if (message.has_ready()) {
            heard.credit += message.ready().frames();
        } else if (message.has_ping()) {
            v1::Envelope answer;
            answer.mutable_pong()->set_client_ns(message.ping().client_ns());
            answer.mutable_pong()->set_monotonic_ns(now_ns());
            end.send(answer);
        }
    }

    /// Returns what is to be said now.
    std::optional<Said> next(bool ready) {
        const std::lock_guard lock(mutex_);
        if (waiting_.empty() && repeated_ && ready) {
            waiting_.push_back(*repeated_);
        }
        if (waiting_.empty() || (waiting_.front().envelope.has_frame() && !ready)) {
            return std::nullopt;
        }
        Said said = waiting_.front();
        waiting_.pop_front();
        if (said.envelope.has_frame()) {
            v1::Frame* const frame = said.envelope.mutable_frame();
            frame->set_sent_monotonic_ns(now_ns() - said.late_ms * 1'000'000);
            frame->set_monotonic_ns(frame->sent_monotonic_ns() - frame->age_ns());
        }
        return said;
    }

    std::mutex mutex_;
    std::deque<Said> waiting_;
    std::optional<Said> repeated_;
    std::atomic<bool> closed_{false};
    v1::Subscribe subscription_;
    FakeDaemon daemon_{[this](ServerEnd& end) { serve(end); }};
};

/// Returns the bytes of a scan: sectors of 30 degrees from -90 on, the one ahead on the left as given.
Bytes scan_bytes(const proto::ScanSector& ahead, std::uint16_t version = proto::scan_version) {
    proto::ScanHead head{};
    head.version = version;
    head.sectors = 6;
    Bytes bytes(proto::scan_bytes(head.sectors));
    std::memcpy(bytes.data(), &head, sizeof head);
    for (std::uint16_t i = 0; i < head.sectors; ++i) {
        proto::ScanSector sector{};
        sector.state = proto::SectorState::free;
        sector.free_mm = 5000;
        if (i == 3) {
            sector = ahead;
        }
        sector.from_cdeg = static_cast<std::int16_t>(-9000 + 3000 * i);
        sector.to_cdeg = static_cast<std::int16_t>(sector.from_cdeg + 3000);
        std::memcpy(bytes.data() + proto::scan_bytes(i), &sector, sizeof sector);
    }
    return bytes;
}

proto::ScanSector sector(proto::SectorState state, std::uint16_t distance_mm, std::uint16_t free_mm) {
    proto::ScanSector made{};
    made.state = state;
    made.distance_mm = distance_mm;
    made.pixels = 100;
    made.free_mm = free_mm;
    return made;
}

const proto::ScanSector free_ahead = sector(proto::SectorState::free, 0, 5000);

/// Returns a frame that is `age_ms` old by its own account, and was sent `late_ms` ago.
Said frame(const Bytes& scan, std::int64_t age_ms = 5, std::int64_t late_ms = 0, std::uint32_t flags = 0) {
    Said said;
    v1::Frame& message = *said.envelope.mutable_frame();
    message.set_sequence(7);
    message.set_age_ns(age_ms * 1'000'000);
    said.late_ms = late_ms;
    message.set_flags(flags);
    v1::PlaneInfo& plane = *message.add_planes();
    plane.set_product(v1::SCAN);
    plane.set_width(static_cast<std::uint32_t>(scan.size()));
    plane.set_height(1);
    plane.set_bytes_per_pixel(1);
    plane.set_payload_bytes(scan.size());
    said.envelope.set_payload_bytes(scan.size());
    said.payload = scan;
    return said;
}

class AvoidFramesTest : public ::testing::TestWithParam<AvoidProgram> {
protected:
    void SetUp() override {
        if (const std::string missing = GetParam().missing(); !missing.empty()) {
            GTEST_SKIP() << missing;
        }
    }

    void start(std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"--speed-mps", "0.1", "--max-age-ms", "10000", daemon_.address()});
        robot_ = GetParam().start(folder_, arguments);
    }

    /// Good frames end the brake. Starts the program where it does not run yet.
    void expect_drive() {
        if (!robot_) {
            start({});
        }
        daemon_.repeat(frame(scan_bytes(free_ahead)));
        EXPECT_TRUE(says(*robot_, "DRIVE 0.10 m/s, free up to 5.0 m"));
        daemon_.repeat(std::nullopt);
    }

    /// The program drives, brakes with this line and drives again.
    void expect_brake(const Said& said, const std::string& line) {
        expect_drive();
        if (said.envelope.has_frame()) {
            daemon_.repeat(said);
        } else {
            daemon_.feed(said);
        }
        EXPECT_TRUE(says(*robot_, line));
        expect_drive();
    }

    TemporaryFolder folder_;
    FedDaemon daemon_;
    std::unique_ptr<DaemonProcess> robot_;
};

TEST_P(AvoidFramesTest, SubscribesToScansAlone) {
    expect_drive();
    const v1::Subscribe subscription = daemon_.subscription();
    ASSERT_EQ(subscription.products_size(), 1);
    EXPECT_EQ(subscription.products(0), v1::SCAN);
}

TEST_P(AvoidFramesTest, AnOldFrame) {
    expect_brake(frame(scan_bytes(free_ahead), 900'000), "BRAKE frame is 900");
}

TEST_P(AvoidFramesTest, AFrameThatWasLongInTheNetwork) {
    // A frame that was longer on its way than those before is left out for a fresh one. When that is no younger, the
    // way has become longer.
    expect_brake(frame(scan_bytes(free_ahead), 5, 900'000), "BRAKE frame is ");
}

TEST_P(AvoidFramesTest, AFrameWithoutAScan) {
    Said said = frame({});
    said.envelope.mutable_frame()->clear_planes();
    expect_brake(said, "BRAKE no scan: set enabled = true in [scan]");
}

TEST_P(AvoidFramesTest, AScanOfAnOlderVersion) {
    expect_brake(frame(scan_bytes(free_ahead, 1)), "BRAKE no scan: the scan has version 1");
}

TEST_P(AvoidFramesTest, AScanThatIsTooShort) {
    expect_brake(frame(Bytes(31)), "BRAKE no scan: the scan has 31 bytes");
}

/// Nearer than 0.19 m a sector of 30 degrees is narrower than the smallest obstacle, 0.1 m.
TEST_P(AvoidFramesTest, UnknownAhead) {
    expect_brake(frame(scan_bytes(sector(proto::SectorState::unknown, 0, 0))),
                 "BRAKE unknown beyond 0.19 m, bearing 15 deg");
}

TEST_P(AvoidFramesTest, AnObstacleAhead) {
    expect_brake(frame(scan_bytes(sector(proto::SectorState::occupied, 420, 420))),
                 "BRAKE obstacle at 0.42 m, bearing 15 deg");
}

TEST_P(AvoidFramesTest, AStateThatNobodyKnows) {
    expect_brake(frame(scan_bytes(sector(proto::SectorState{9}, 3000, 250))),
                 "BRAKE unknown beyond 0.25 m, bearing 15 deg");
}

TEST_P(AvoidFramesTest, AGap) {
    expect_brake(frame(scan_bytes(free_ahead), 5, 0, v1::DISCONTINUITY), "BRAKE gap in the frames");
}

TEST_P(AvoidFramesTest, ARenderedFrame) {
    expect_brake(frame(scan_bytes(free_ahead), 5, 0, v1::SYNTHETIC), "BRAKE frame is synthetic");
}

TEST_P(AvoidFramesTest, ADaemonThatRefuses) {
    Said said;
    said.envelope.mutable_error()->set_message("not today");
    said.last = true;
    expect_brake(said, "BRAKE no scan: disparityd at " + daemon_.address() + ": not today");
}

TEST_P(AvoidFramesTest, ADaemonThatBreaksTheProtocol) {
    Said said = frame(scan_bytes(free_ahead));
    said.envelope.mutable_frame()->mutable_planes(0)->set_width(70'000);
    said.last = true;
    expect_brake(said, "BRAKE no scan: disparityd at " + daemon_.address() + ": broke the protocol: ");
}

TEST_P(AvoidFramesTest, JsonForEachFrame) {
    start({"--json"});
    std::vector<nlohmann::json> frames;
    daemon_.repeat(frame(scan_bytes(free_ahead)));
    EXPECT_TRUE(robot_->wait_for_line([&](const std::string& line) {
        const nlohmann::json one = nlohmann::json::parse(line);
        if (!one.at("sequence").is_null()) {
            frames.push_back(one);
        }
        return frames.size() == 3;
    })) << robot_->log();
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[1].at("state"), "BRAKE");
    EXPECT_EQ(frames[1].at("speed_mps"), 0.0);
    EXPECT_EQ(frames[2].at("state"), "DRIVE");
    EXPECT_EQ(frames[2].at("sequence"), 7);
    EXPECT_EQ(frames[2].at("speed_mps"), 0.1);
    EXPECT_NEAR(frames[2].at("ahead_m").get<double>(), 4.994, 1e-9);
    EXPECT_EQ(frames[2].at("reason"), "free up to 5.0 m");
    EXPECT_EQ(frames[2].size(), 5U);
}

INSTANTIATE_TEST_SUITE_P(Programs, AvoidFramesTest, ::testing::Values(AvoidProgram{false}, AvoidProgram{true}),
                         [](const auto& made) { return language_of(made.param); });

}  // namespace
}  // namespace disparityd::test
