// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "tools/schedule/simulation.h"

namespace disparityd::schedule {
namespace {

constexpr int width = 640;
constexpr int height = 480;

double simulated(const TaskTimes& times, int workers, int rows_at_once = 1) {
    return simulate({width, rows_at_once, cpu::SweepPlan(width, height, rows_at_once, workers, 64)}, times, workers);
}

TEST(ScheduleTest, OneWorkerDoesOneThingAfterTheOther) {
    const TaskTimes times{3, {5, 7}, 11};
    EXPECT_NEAR(simulated(times, 1), height * (3 + 5 + 7 + 11), 1e-6 * height);
    EXPECT_NEAR(simulated(times, 1, 2), height / 2 * (3 + 5 + 7 + 11), 1e-6 * height);
}

TEST(ScheduleTest, TwoWorkersTakeASweepEach) {
    const TaskTimes times{3, {5, 7}, 11};
    // Who comes to the middle first computes costs that the other one is about to leave.
    EXPECT_NEAR(simulated(times, 2), height / 2 * (3 + 5 + 7 + 11), 3 + 1e-6 * height);
}

TEST(ScheduleTest, WhatDependsOnNothingIsSharedByAll) {
    const TaskTimes times{10, {0, 0}, 10};
    for (const int workers : {3, 4, 8, 16}) {
        const double best = height * 20.0 / workers;
        EXPECT_GE(simulated(times, workers), best);
        EXPECT_LT(simulated(times, workers), best * 1.1 + 40) << workers;
    }
}

TEST(ScheduleTest, RowsFollowEachOtherAtTheDistanceOfTheKernels) {
    const TaskTimes times{0, {10, 10}, 0};
    const cpu::SweepPlan plan(width, height, 1, 64, 64);
    // A row waits for the end of a step of the row before that is one block further, and then goes that far itself.
    const int steps = plan.steps_at_once();
    ASSERT_EQ(steps, cpu::min_block);
    const double lag = 10.0 * 2 * steps / width;
    EXPECT_GT(simulated(times, 64), lag * (height - 2));
    EXPECT_LT(simulated(times, 64), 2 * (lag + 10.0 * steps / width) * height);
}

TEST(ScheduleTest, NeverMoreThanWorkersTimesFaster) {
    const TaskTimes times{4, {10, 11}, 8};
    for (int workers = 2; workers <= 64; ++workers) {
        EXPECT_GT(simulated(times, workers) * workers, simulated(times, 1) * 0.999) << workers;
    }
}

}  // namespace
}  // namespace disparityd::schedule
