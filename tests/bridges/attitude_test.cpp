// SPDX-License-Identifier: Apache-2.0
//
// The way of the autopilot's attitude: frames, directions, and what is given to the daemon.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridges/mavlink/attitude_relay.h"
#include "tests/bridges/attitude_frame.h"

namespace disparityd::mavlink {
namespace {

using namespace std::chrono_literals;
using test::attitude_frame;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr float quarter = std::numbers::pi_v<float> / 2;

std::vector<ReceivedFrame> frames_in(FrameReader& reader, std::span<const std::uint8_t> bytes) {
    std::vector<ReceivedFrame> frames;
    reader.take(bytes, [&](const ReceivedFrame& frame) { frames.push_back(frame); });
    return frames;
}

Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

TEST(FrameReader, FindsFramesHoweverTheyAreCut) {
    FrameWriter other(9, 9);
    const Bytes bytes = joined({{1, 0xfd, 2, 0xfd, 0xfd},
                                attitude_frame(1, 1, 0.5F, 0),
                                other.frame({{0, 50, 9}, Bytes(9, 0xfd)}),
                                attitude_frame(2, 7, 0, 0.25F),
                                {0xfd, 0xfd}});
    for (std::size_t step : {std::size_t{1}, std::size_t{3}, std::size_t{11}, bytes.size()}) {
        FrameReader reader(attitude_kind);
        std::vector<ReceivedFrame> found;
        for (std::size_t at = 0; at < bytes.size(); at += step) {
            for (ReceivedFrame& frame :
                 frames_in(reader, std::span(bytes).subspan(at, std::min(step, bytes.size() - at)))) {
                found.push_back(std::move(frame));
            }
        }
        ASSERT_EQ(found.size(), 2U) << step;
        EXPECT_EQ(found[0].system, 1);
        EXPECT_EQ(found[1].system, 2);
        EXPECT_EQ(found[1].component, 7);
        EXPECT_EQ(found[1].payload.size(), attitude_kind.length) << "zeros that were not sent are there";
    }
}

TEST(FrameReader, TakesNoFrameThatIsDamaged) {
    const Bytes good = attitude_frame(1, 1, 0.5F, 0.25F);
    for (std::size_t i = 0; i < good.size(); ++i) {
        Bytes bad = good;
        bad[i] ^= 0x40;
        FrameReader reader(attitude_kind);
        EXPECT_TRUE(frames_in(reader, bad).empty()) << i;
    }
    Bytes checked = good;
    checked[2] = 1;  // signed: 13 bytes follow, which are not checked; the checksum is of other bytes now
    FrameReader reader(attitude_kind);
    EXPECT_TRUE(frames_in(reader, joined({checked, Bytes(13)})).empty());
    const std::size_t end = checked.size() - 2;
    const std::uint16_t sum = crc(std::span(&attitude_kind.crc_extra, 1), crc(std::span(checked).subspan(1, end - 1)));
    checked[end] = static_cast<std::uint8_t>(sum);
    checked[end + 1] = static_cast<std::uint8_t>(sum >> 8);
    EXPECT_EQ(frames_in(reader, joined({checked, Bytes(13), good})).size(), 2U);
}

TEST(FrameReader, SurvivesAnyBytes) {
    std::mt19937 random(5);
    FrameReader reader(attitude_kind);
    for (int round = 0; round < 2000; ++round) {
        Bytes bytes(random() % 400);
        for (std::uint8_t& byte : bytes) {
            byte = random() % 3 == 0 ? frame_magic : static_cast<std::uint8_t>(random() % 40);
        }
        EXPECT_TRUE(frames_in(reader, bytes).empty());
    }
    const Bytes zeros(600);
    EXPECT_TRUE(frames_in(reader, zeros).empty());
    EXPECT_EQ(frames_in(reader, attitude_frame(1, 1, 0, 0)).size(), 1U) << "it goes on with the next frame";
}

disparity::Level level_for(float roll, float pitch) {
    const Bytes frame = attitude_frame(1, 1, roll, pitch);
    FrameReader reader(attitude_kind);
    const auto level = level_of(frames_in(reader, frame).at(0).payload);
    EXPECT_TRUE(level);
    return level.value_or(disparity::Level());
}

TEST(Attitude, SaysWhereUpIs) {
    const auto near = [](const disparity::Level& level, double ahead, double left, double up) {
        EXPECT_NEAR(level.ahead, ahead, 1e-6);
        EXPECT_NEAR(level.left, left, 1e-6);
        EXPECT_NEAR(level.up, up, 1e-6);
    };
    near(level_for(0, 0), 0, 0, 1);
    near(level_for(0, quarter), 1, 0, 0);  // the nose points up
    near(level_for(quarter, 0), 0, 1, 0);  // on its right side, the left one is up
    near(level_for(2 * quarter, 0), 0, 0, -1);
    near(level_for(0.3F, -0.2F), std::sin(-0.2F), std::sin(0.3F) * std::cos(-0.2F), std::cos(0.3F) * std::cos(-0.2F));
}

TEST(Attitude, WhatIsNoNumberIsNoLevel) {
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (const auto& [roll, pitch] : {std::pair{wrong, 0.0F}, std::pair{0.0F, wrong}}) {
            FrameReader reader(attitude_kind);
            EXPECT_FALSE(level_of(frames_in(reader, attitude_frame(1, 1, roll, pitch)).at(0).payload));
        }
    }
}

class HeldGiver : public LevelGiver {
public:
    std::vector<disparity::Level> given;
    int calls = 0;
    bool refuses = false;

private:
    void give(const std::vector<disparity::Level>& levels) override {
        ++calls;
        if (refuses) {
            throw std::runtime_error("level: refused");
        }
        given = levels;
    }
};

TEST(AttitudeRelay, GivesWhatTheVehiclesAutopilotTells) {
    HeldGiver giver;
    AttitudeRelay relay(42, giver);
    const auto now = AttitudeRelay::Clock::now();
    std::vector<Message> sent;
    const auto send = [&](const Message& message) {
        sent.push_back(message);
        return true;
    };
    relay.step(now, send);
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_EQ(sent[0].kind.id, 76U);
    EXPECT_EQ(sent[0].payload.size(), 33U);
    EXPECT_EQ(sent[0].payload[30], 42);
    EXPECT_EQ(giver.calls, 0);
    EXPECT_THAT(relay.problem(now), HasSubstr("no ATTITUDE in MAVLink 2 comes from component 1 of system 42"));
    relay.take(attitude_frame(41, 1, 0, 0.1F), now);
    relay.take(attitude_frame(42, 196, 0, 0.1F), now);
    relay.take(attitude_frame(42, 1, std::nanf(""), 0.1F), now);
    relay.step(now + 999ms, send);
    EXPECT_EQ(sent.size(), 1U) << "once a second";
    EXPECT_EQ(giver.calls, 0) << "of another vehicle, of another component, or no number";
    relay.step(now + 1s, send);
    EXPECT_EQ(sent.size(), 2U);
    relay.take(joined({attitude_frame(42, 1, 0, 0.1F), attitude_frame(42, 1, 0, 0.2F)}), now + 1s);
    relay.step(now + 2s, send);
    EXPECT_EQ(sent.size(), 2U);
    EXPECT_EQ(giver.calls, 1) << "both at once";
    ASSERT_EQ(giver.given.size(), 2U);
    EXPECT_NEAR(giver.given[1].ahead, std::sin(0.2), 1e-6);
    EXPECT_EQ(relay.problem(now + 2s), "");
    EXPECT_NE(relay.problem(now + 2001ms), "");
}

TEST(LevelGiver, TellsTheAgeAndRestsAfterARefusal) {
    HeldGiver giver;
    giver.add({0, 0, 1, 0us}, LevelGiver::Clock::now() - 50ms);
    giver.LevelGiver::give();
    ASSERT_EQ(giver.given.size(), 1U);
    EXPECT_GE(giver.given[0].age, 50ms);
    giver.LevelGiver::give();
    EXPECT_EQ(giver.calls, 1) << "nothing has come";
    for (int i = 0; i < 100; ++i) {
        giver.add({0, 0, 1, 0us}, LevelGiver::Clock::now());
    }
    giver.LevelGiver::give();
    EXPECT_EQ(giver.given.size(), 64U);
    giver.refuses = true;
    giver.add({0, 0, 1, 0us}, LevelGiver::Clock::now());
    giver.LevelGiver::give();
    EXPECT_EQ(giver.problem(), "level: refused");
    EXPECT_EQ(giver.calls, 3);
}

}  // namespace
}  // namespace disparityd::mavlink
