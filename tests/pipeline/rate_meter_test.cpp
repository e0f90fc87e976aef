// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rate_meter.h"

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(RateMeter, MeasuresASteadyRate) {
    RateMeter meter;
    const auto start = Clock::now();
    auto now = start;
    for (int i = 0; i < 200; ++i, now += 10ms) {
        meter.tick(now);
    }
    EXPECT_NEAR(meter.per_second(now), 100, 1);
}

TEST(RateMeter, DecaysAndForgets) {
    RateMeter meter;
    const auto start = Clock::now();
    auto now = start;
    for (int i = 0; i < 100; ++i, now += 10ms) {
        meter.tick(now);
    }
    EXPECT_LT(meter.per_second(now + 1s), 60);
    EXPECT_EQ(meter.per_second(now + 6s), 0);
}

TEST(RateMeter, FasterThanItsRing) {
    RateMeter meter;
    const auto start = Clock::now();
    auto now = start;
    for (int i = 0; i < 5000; ++i, now += 1ms) {
        meter.tick(now);
    }
    EXPECT_NEAR(meter.per_second(now), 1000, 5);
}

TEST(RateMeter, OneTickIsNoRate) {
    RateMeter meter;
    meter.tick(Clock::now());
    EXPECT_EQ(meter.per_second(Clock::now()), 0);
}

}  // namespace
}  // namespace disparityd::pipeline
