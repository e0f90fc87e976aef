// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_clock.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

constexpr std::int64_t sensor_ms = 1'000'000;
constexpr std::int64_t second = 1'000 * sensor_ms;

/// A camera that measures 400 times a second by a clock of its own, and a way to the host that takes its time.
class SensorClockTest : public ::testing::Test {
protected:
    /// When it was measured on the host's clock, and what the mapping says.
    struct Mapped {
        std::int64_t truth;
        std::int64_t arrived;
        std::optional<std::int64_t> mapped;
    };

    Mapped next() {
        true_ns_ += 2'500'000;
        camera_ns_ += static_cast<std::int64_t>(2'500'000 / (1 + drift_));
        // Mostly some tenths of a millisecond; sometimes the host has other things to do. Never out of order.
        std::int64_t way = least_way + static_cast<std::int64_t>(400'000 * exponential_(random_));
        if (busy_(random_)) {
            way += static_cast<std::int64_t>(100 * sensor_ms * exponential_(random_));
        }
        arrived_ns_ = std::max(arrived_ns_ + 1, true_ns_ + way);
        return {true_ns_, arrived_ns_, clock_.map(camera_ns_, arrived_ns_)};
    }

    void run(std::int64_t time) {
        for (const std::int64_t end = true_ns_ + time; true_ns_ < end;) {
            next();
        }
    }

    /// The largest error, early or late, over this time; every sample is mapped, none after it arrived, and times rise.
    std::int64_t worst_error(std::int64_t time) {
        std::int64_t worst = 0;
        std::int64_t last = std::numeric_limits<std::int64_t>::min();
        for (const std::int64_t end = true_ns_ + time; true_ns_ < end;) {
            const Mapped sample = next();
            if (!sample.mapped) {
                ADD_FAILURE() << "not mapped";
                return second;
            }
            EXPECT_LE(*sample.mapped, sample.arrived);
            EXPECT_GT(*sample.mapped, last);
            last = *sample.mapped;
            worst = std::max(worst, std::abs(*sample.mapped - sample.truth - least_way));
        }
        return worst;
    }

    static constexpr std::int64_t least_way = 200'000;
    SensorClock clock_;
    double drift_ = 0;
    std::int64_t true_ns_ = 1'000 * second;
    std::int64_t camera_ns_ = 77 * second;
    std::int64_t arrived_ns_ = 0;
    std::mt19937 random_{3};
    std::exponential_distribution<double> exponential_{1.0};
    std::bernoulli_distribution busy_{0.02};
};

TEST_F(SensorClockTest, FirstSamplesHaveNoTime) {
    for (int i = 0; i < SensorClock::settling_samples; ++i) {
        EXPECT_FALSE(next().mapped);
    }
    EXPECT_TRUE(next().mapped);
}

TEST_F(SensorClockTest, IsRightFromTheFirstTimesOn) {
    for (int i = 0; i < SensorClock::settling_samples; ++i) {
        next();
    }
    EXPECT_LT(worst_error(2 * second), sensor_ms);
}

TEST_F(SensorClockTest, FollowsClocksThatRunApart) {
    for (const double drift : {80e-6, -150e-6}) {
        clock_ = SensorClock();
        drift_ = drift;
        run(20 * second);
        EXPECT_LT(worst_error(100 * second), sensor_ms / 10) << drift;
        EXPECT_NEAR(clock_.drift(), drift, 3e-6);
        EXPECT_EQ(clock_.jumps(), 0U);
    }
}

TEST_F(SensorClockTest, ABacklogAtTheStartDoesNoHarm) {
    // What the kernel kept while nobody read comes at once.
    arrived_ns_ = true_ns_ + 150 * sensor_ms;
    for (int i = 0; i < SensorClock::settling_samples; ++i) {
        next();
    }
    EXPECT_LT(worst_error(second), sensor_ms);
}

TEST_F(SensorClockTest, ALongDelayMovesNoTime) {
    run(20 * second);
    arrived_ns_ = true_ns_ + 2 * second;
    EXPECT_LT(worst_error(10 * second), sensor_ms / 5);
    EXPECT_EQ(clock_.jumps(), 0U);
}

TEST_F(SensorClockTest, ARestartedCameraBeginsAnew) {
    run(10 * second);
    camera_ns_ = 0;
    EXPECT_FALSE(next().mapped);
    run(second);
    EXPECT_LT(worst_error(second), sensor_ms);
    EXPECT_EQ(clock_.jumps(), 1U);
}

TEST_F(SensorClockTest, AClockThatJumpsAheadBeginsAnew) {
    run(10 * second);
    camera_ns_ += 5 * second;
    EXPECT_FALSE(next().mapped);
    run(second);
    EXPECT_LT(worst_error(second), sensor_ms);
    EXPECT_EQ(clock_.jumps(), 1U);
}

TEST_F(SensorClockTest, AClockThatStoodStillIsFoundOut) {
    run(10 * second);
    true_ns_ += 30 * second;
    run(6 * second);
    EXPECT_EQ(clock_.jumps(), 1U);
    EXPECT_LT(worst_error(second), sensor_ms);
}

TEST_F(SensorClockTest, ArbitraryTimesKeepTheOrder) {
    std::int64_t arrived = 0;
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    for (int i = 0; i < 20'000; ++i) {
        arrived += static_cast<std::int64_t>(random_() % 5'000'000);
        const auto camera = static_cast<std::int64_t>((static_cast<std::uint64_t>(random_()) << 30U) >> (i / 400));
        if (const auto mapped = clock_.map(camera, arrived)) {
            EXPECT_GT(*mapped, last);
            last = *mapped;
        }
    }
}

}  // namespace
}  // namespace disparityd::capture
