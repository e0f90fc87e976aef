// SPDX-License-Identifier: Apache-2.0
#include "daemon/level_watch.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/scan.h"

namespace disparityd::daemon {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr LevelWatch::Time moment{1h};

v1::GiveLevel upright(std::uint32_t age_us = 0) {
    v1::GiveLevel message;
    message.add_samples()->set_up(1);
    message.mutable_samples(0)->set_age_us(age_us);
    return message;
}

std::string refusal(LevelWatch& watch, const v1::GiveLevel& message, std::uint64_t client, LevelWatch::Time now) {
    try {
        watch.take(message, client, now);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return {};
}

/// Publishes a scan whose level comes from there.
void note(LevelWatch& watch, proto::GroundSource ground, LevelWatch::Time now) {
    proto::ScanHead head{};
    head.ground = ground;
    watch.note({reinterpret_cast<const std::uint8_t*>(&head), sizeof head, 1, sizeof head}, now);
}

TEST(LevelWatchTest, TakesTheLevelsOfOneClientAtATime) {
    LevelWatch watch(GroundMode::autopilot, true);
    EXPECT_EQ(refusal(watch, upright(50000), 1, moment), "");
    ASSERT_NE(watch.given(), nullptr);
    EXPECT_EQ(watch.given()->newest_ns(), std::chrono::nanoseconds(moment.time_since_epoch() - 50ms).count());
    EXPECT_THAT(refusal(watch, upright(), 2, moment + 999ms), HasSubstr("another client gives it"));
    EXPECT_EQ(refusal(watch, upright(), 1, moment + 900ms), "");
    EXPECT_THAT(refusal(watch, upright(), 2, moment + 1899ms), HasSubstr("another client gives it"));
    EXPECT_EQ(refusal(watch, upright(), 2, moment + 1900ms), "") << "the first one has been silent for a second";
    EXPECT_THAT(refusal(watch, upright(), 1, moment + 1900ms), HasSubstr("another client gives it"));
}

TEST(LevelWatchTest, TakesNoneForReplaysAndOtherGrounds) {
    LevelWatch replay(GroundMode::autopilot, false);
    EXPECT_EQ(replay.given(), nullptr);
    EXPECT_THAT(refusal(replay, upright(), 1, moment), HasSubstr("found a replay"));
    LevelWatch gravity(GroundMode::gravity, true);
    EXPECT_EQ(gravity.given(), nullptr);
    EXPECT_THAT(refusal(gravity, upright(), 1, moment), HasSubstr("found ground = \"gravity\""));
    LevelWatch none(std::nullopt, true);
    EXPECT_EQ(none.given(), nullptr);
    EXPECT_THAT(refusal(none, upright(), 1, moment), HasSubstr("found no obstacle scan"));
    EXPECT_FALSE(none.status(moment));
    EXPECT_FALSE(LevelWatch(GroundMode::fitted, true).status(moment));
}

TEST(LevelWatchTest, ARefusedMessageLeavesNothingBehind) {
    LevelWatch watch(GroundMode::autopilot, true);
    v1::GiveLevel half = upright();
    half.add_samples();  // no direction
    EXPECT_THAT(refusal(watch, half, 1, moment), HasSubstr("allowed: a direction of length 1"));
    EXPECT_FALSE(watch.given()->newest_ns());
    EXPECT_EQ(refusal(watch, upright(), 2, moment), "") << "nor a client that gives";
}

TEST(LevelWatchTest, KnowsWhereTheLevelComesFromAndHowOldItIs) {
    LevelWatch autopilot(GroundMode::autopilot, true);
    EXPECT_EQ(autopilot.status(moment)->source(), "");
    EXPECT_EQ(autopilot.status(moment)->age_ms(), 0);
    autopilot.take(upright(20000), 1, moment);
    note(autopilot, proto::GroundSource::autopilot, moment + 10ms);
    EXPECT_EQ(autopilot.status(moment + 10ms)->source(), "autopilot");
    EXPECT_NEAR(autopilot.status(moment + 10ms)->age_ms(), 30, 1e-3);
    note(autopilot, proto::GroundSource::configured, moment + 500ms);
    EXPECT_EQ(autopilot.status(moment + 500ms)->source(), "");
    EXPECT_NEAR(autopilot.status(moment + 500ms)->age_ms(), 520, 1e-3);

    LevelWatch inertial(GroundMode::gravity, true);
    note(inertial, proto::GroundSource::gravity, moment);
    EXPECT_EQ(inertial.status(moment + 5ms)->source(), "inertial");
    EXPECT_NEAR(inertial.status(moment + 5ms)->age_ms(), 5, 1e-3);
}

}  // namespace
}  // namespace disparityd::daemon
