// SPDX-License-Identifier: Apache-2.0
#include "pipeline/gravity_filter.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using capture::SensorSample;

constexpr std::int64_t ms = 1'000'000;
constexpr float g = 9.81F;

/// A filter of a sensor whose z axis points up at rest, and a clock that goes on by 2.5 ms with each sample.
struct Sensor {
    GravityFilter filter;
    std::int64_t now = 5'000 * ms;

    void feed(int count, capture::SensorVector acceleration) {
        std::vector<SensorSample> samples(static_cast<std::size_t>(count));
        for (SensorSample& sample : samples) {
            now += 5 * ms / 2;
            sample.monotonic_ns = now;
            sample.flags = capture::sensor_flag_inertial;
            sample.acceleration = acceleration;
        }
        filter.add(samples);
    }
    void rest(int count) { feed(count, {0, 0, g}); }
    /// How far up is from straight up, degrees; more than 180 where it is not known.
    double lean() const {
        const auto up = filter.up_at(now);
        return up ? std::atan2(std::hypot(up->x, up->y), up->z) * 180 / 3.14159265358979 : 999;
    }
};

TEST(GravityFilter, AtRestUpIsUp) {
    Sensor sensor;
    sensor.rest(200);
    const auto up = sensor.filter.up_at(sensor.now);
    ASSERT_TRUE(up);
    EXPECT_GT(up->z, 0);
    EXPECT_EQ(up->x, 0);
    EXPECT_EQ(up->y, 0);
}

TEST(GravityFilter, KnowsNothingBeforeTheFirstTenthOfASecond) {
    Sensor sensor;
    EXPECT_FALSE(sensor.filter.up_at(sensor.now));
    sensor.rest(30);
    EXPECT_FALSE(sensor.filter.up_at(sensor.now));
    sensor.rest(30);
    EXPECT_TRUE(sensor.filter.up_at(sensor.now));
}

TEST(GravityFilter, FollowsATurnWithinItsTime) {
    Sensor sensor;
    sensor.rest(400);
    const float ten = 0.174533F;
    sensor.feed(200, {g * std::sin(ten), 0, g * std::cos(ten)});  // half a second
    EXPECT_NEAR(sensor.lean(), 10 * (1 - std::exp(-1)), 0.5);
    sensor.feed(1200, {g * std::sin(ten), 0, g * std::cos(ten)});
    EXPECT_NEAR(sensor.lean(), 10, 0.1);
}

TEST(GravityFilter, AShakenCameraKeepsWhatItKnewForAWhile) {
    Sensor sensor;
    sensor.rest(400);
    sensor.feed(120, {6, 0, g});  // 0.3 s, longer than gravity by 1.7 m/s²
    EXPECT_LT(sensor.lean(), 1e-6) << "none of that counts";
    sensor.feed(400, {6, 0, g});
    EXPECT_FALSE(sensor.filter.up_at(sensor.now)) << "a second of it is too much";
    sensor.rest(60);
    EXPECT_LT(sensor.lean(), 1e-6);
}

TEST(GravityFilter, WhatIsNearlyGravityCountsLess) {
    Sensor half, all;
    half.rest(100);
    all.rest(100);
    half.feed(10, {0, 3, std::sqrt((g + 0.5F) * (g + 0.5F) - 9)});
    all.feed(10, {0, 3, std::sqrt(g * g - 9)});
    EXPECT_NEAR(half.lean() / all.lean(), 0.5, 0.05);
}

TEST(GravityFilter, OldSamplesAreNotTaken) {
    Sensor sensor;
    sensor.rest(200);
    EXPECT_TRUE(sensor.filter.up_at(sensor.now + 999 * ms));
    EXPECT_FALSE(sensor.filter.up_at(sensor.now + 1001 * ms));
    EXPECT_FALSE(sensor.filter.up_at(sensor.now - 1001 * ms)) << "nor those of another clock";
}

TEST(GravityFilter, BeginsAnewWhenTimesFall) {
    Sensor sensor;
    sensor.feed(400, {g, 0, 0});
    sensor.now = 0;
    sensor.rest(100);
    EXPECT_LT(sensor.lean(), 1e-6) << "a recording that is played again";
}

TEST(GravityFilter, OtherSamplesDoNotCount) {
    Sensor sensor;
    sensor.rest(200);
    const auto before = sensor.filter.up_at(sensor.now);
    std::vector<SensorSample> samples(100);
    for (SensorSample& sample : samples) {
        sample.monotonic_ns = sensor.now += ms;
        sample.flags = capture::sensor_flag_magnetic;
        sample.acceleration = {g, 0, 0};
    }
    sensor.filter.add(samples);
    EXPECT_EQ(sensor.filter.up_at(sensor.now), before);
}

TEST(GravityFilter, AnyValuesAreTaken) {
    Sensor sensor;
    constexpr float inf = std::numeric_limits<float>::infinity();
    constexpr float most = std::numeric_limits<float>::max();
    for (const capture::SensorVector wild : {capture::SensorVector{NAN, 0, 0}, {inf, -inf, 0}, {most, most, most}}) {
        sensor.feed(100, wild);
        EXPECT_FALSE(sensor.filter.up_at(sensor.now));
    }
    std::vector<SensorSample> samples(2);
    samples[0].flags = samples[1].flags = capture::sensor_flag_inertial;
    samples[0].monotonic_ns = std::numeric_limits<std::int64_t>::min();
    samples[1].monotonic_ns = std::numeric_limits<std::int64_t>::max();
    sensor.filter.add(samples);
    EXPECT_FALSE(sensor.filter.up_at(0));
    EXPECT_FALSE(sensor.filter.up_at(std::numeric_limits<std::int64_t>::min()));
    Sensor fresh;
    fresh.rest(100);
    EXPECT_TRUE(fresh.filter.up_at(fresh.now));
}

}  // namespace
}  // namespace disparityd::pipeline
