// SPDX-License-Identifier: Apache-2.0
#include "capture/pacer.h"

#include <limits>

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;

constexpr Pacer::Time start{1h};

TEST(Pacer, TheFirstFrameIsDueAtOnce) {
    EXPECT_EQ(Pacer().due(start, 100ms), start);
}

TEST(Pacer, ATimeFollowsFromTheOneBefore) {
    Pacer pacer;
    pacer.due(start, 100ms);
    EXPECT_EQ(pacer.due(start + 30ms, 100ms), start + 100ms) << "the taker is early";
    EXPECT_EQ(pacer.due(start + 700ms, 50ms), start + 150ms) << "the taker is late";
    EXPECT_EQ(pacer.due(start + 700ms, 100ms), start + 250ms) << "delays do not add up";
}

TEST(Pacer, ATakerMoreThanASecondLateGetsNoBurst) {
    Pacer pacer;
    pacer.due(start, 100ms);
    EXPECT_EQ(pacer.due(start + 1100ms, 100ms), start + 100ms) << "a second is not too late";
    EXPECT_EQ(pacer.due(start + 1200ms + 1ns, 100ms), start + 1200ms + 1ns);
    EXPECT_EQ(pacer.due(start + 1250ms, 100ms), start + 1300ms + 1ns) << "from the new time on";
}

TEST(RecordedStep, IsTheDistanceOfTheTimes) {
    EXPECT_EQ(recorded_step(-5, 20, 100ms), 25ns);
}

TEST(RecordedStep, IsThePeriodWhereTheTimeDoesNotRise) {
    EXPECT_EQ(recorded_step(20, 20, 100ms), 100ms);
    EXPECT_EQ(recorded_step(20, 19, 100ms), 100ms);
}

TEST(RecordedStep, IsAtMostADay) {
    constexpr std::int64_t day_ns = 86'400'000'000'000;
    using Limits = std::numeric_limits<std::int64_t>;
    EXPECT_EQ(recorded_step(0, day_ns - 1, 100ms), std::chrono::nanoseconds(day_ns - 1));
    EXPECT_EQ(recorded_step(0, day_ns + 1, 100ms), 24h);
    EXPECT_EQ(recorded_step(Limits::min(), Limits::max(), 100ms), 24h);
}

}  // namespace
}  // namespace disparityd::capture
