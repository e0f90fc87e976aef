// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_recovery.h"

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using Step = CameraRecovery::Step;

class CameraRecoveryTest : public ::testing::Test {
protected:
    /// The next step that is handed out within the time; wait when there is none. The clock moves there.
    Step step_within(std::chrono::milliseconds time) {
        const auto until = now_ + time;
        for (;;) {
            const Step step = recovery_.due(now_);
            if (step != Step::wait || recovery_.next() > until) {
                now_ = step == Step::wait ? until : now_;
                return step;
            }
            now_ = recovery_.next();
        }
    }

    void frames_for(std::chrono::milliseconds time) {
        for (const auto until = now_ + time; now_ < until; now_ += 33ms) {
            EXPECT_EQ(recovery_.due(now_), Step::wait);
            recovery_.frame(now_);
        }
    }

    CameraRecovery::Time now_{1h};
    CameraRecovery recovery_{{}, now_};
};

TEST_F(CameraRecoveryTest, LooksForACameraAtOnceAndThenAtIntervals) {
    EXPECT_EQ(recovery_.due(now_), Step::open);
    recovery_.absent(now_);
    EXPECT_EQ(step_within(249ms), Step::wait);
    EXPECT_EQ(step_within(1ms), Step::open);
}

TEST_F(CameraRecoveryTest, ASteadyCameraIsLeftAlone) {
    recovery_.started(now_);
    frames_for(60s);
}

TEST_F(CameraRecoveryTest, AStallClimbsTheLadderInOrder) {
    recovery_.started(now_);
    frames_for(5s);
    EXPECT_EQ(step_within(900ms), Step::wait);
    EXPECT_EQ(step_within(200ms), Step::restart);
    recovery_.started(now_);
    EXPECT_EQ(step_within(1900ms), Step::wait);
    EXPECT_EQ(step_within(200ms), Step::reopen);
    recovery_.reopen_at_once(now_);
    EXPECT_EQ(recovery_.due(now_), Step::open);
    recovery_.started(now_);
    EXPECT_EQ(step_within(2100ms), Step::reset);
    recovery_.absent(now_);
    EXPECT_EQ(step_within(250ms), Step::open);
}

TEST_F(CameraRecoveryTest, PatienceGrowsWithLaddersClimbedInVain) {
    recovery_.started(now_);
    std::chrono::milliseconds expected = 2000ms;
    for (int round = 0; round < 5; ++round) {
        for (const Step step : {Step::restart, Step::reopen, Step::reset}) {
            EXPECT_EQ(step_within(expected - 1ms), Step::wait) << round;
            EXPECT_EQ(step_within(1ms), step) << round;
            recovery_.started(now_);
        }
        expected = std::min(2 * expected, 10000ms);
    }
}

TEST_F(CameraRecoveryTest, AFewFramesDoNotResetTheLadderButSteadyOnesDo) {
    recovery_.started(now_);
    EXPECT_EQ(step_within(2s), Step::restart);
    recovery_.started(now_);
    recovery_.frame(now_);
    EXPECT_EQ(step_within(1s), Step::reopen);
    recovery_.started(now_);
    frames_for(3s);
    EXPECT_EQ(step_within(1s), Step::restart);
}

TEST_F(CameraRecoveryTest, AnErrorIsHelpedAtOnceTheFirstTime) {
    recovery_.started(now_);
    recovery_.failed();
    EXPECT_EQ(recovery_.due(now_), Step::restart);
    recovery_.failed();
    EXPECT_EQ(recovery_.due(now_), Step::reopen);
    recovery_.started(now_);
    recovery_.failed();
    EXPECT_EQ(recovery_.due(now_), Step::reset);
    recovery_.started(now_);
    recovery_.failed();
    EXPECT_EQ(step_within(3s), Step::wait) << "no storm of resets";
    EXPECT_EQ(step_within(1s), Step::restart);
}

TEST_F(CameraRecoveryTest, AnotherPluggingBeginsBelow) {
    recovery_.started(now_);
    EXPECT_EQ(step_within(2s), Step::restart);
    recovery_.absent(now_);
    recovery_.forget_attempts();
    recovery_.started(now_);
    EXPECT_EQ(step_within(2s), Step::restart);
}

}  // namespace
}  // namespace disparityd::capture
