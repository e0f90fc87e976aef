// SPDX-License-Identifier: Apache-2.0
//
// A budget of processor time, kept with a made clock.
#include "pipeline/core_budget.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;

/// A camera and a process whose time is made: each frame that begins costs so much, spread over the time after it.
class Process {
public:
    Process(double cores, double rate) : budget_(cores, [this] { return now_; }), interval_(1 / rate) {}

    /// Lets frames come for so long, of which each costs `cost` when it begins; the rest of the process uses `other`
    /// cores. Returns the numbers of the frames that began.
    std::vector<int> run(double seconds, double cost, double other = 0) {
        std::vector<int> begun;
        for (long left = std::lround(seconds / interval_); left > 0; --left) {
            pass(interval_, other);
            if (budget_.admits()) {
                begun.push_back(came_);
                in_work_.push_back(cost);
            }
            ++came_;
        }
        return begun;
    }

    void pass(double seconds, double other) {
        now_.time += std::chrono::duration_cast<CoreBudget::Time::duration>(CoreBudget::Seconds(seconds));
        now_.used += CoreBudget::Seconds(seconds * other);
        while (in_work_.size() > in_flight) {
            now_.used += CoreBudget::Seconds(in_work_.front());
            in_work_.pop_front();
        }
    }

    double used() const { return now_.used.count(); }
    CoreBudget& budget() { return budget_; }

private:
    static constexpr std::size_t in_flight = 3;  ///< what has begun is spent so many frames later

    CoreBudget::Moment now_{CoreBudget::Time(1h), CoreBudget::Seconds(7)};
    CoreBudget budget_;
    const double interval_;
    std::deque<double> in_work_;
    int came_ = 0;
};

/// The longest and the shortest way from a frame that began to the next one, in frames.
std::pair<int, int> gaps_of(const std::vector<int>& begun) {
    int least = 1000, most = 0;
    for (std::size_t i = 1; i < begun.size(); ++i) {
        least = std::min(least, begun[i] - begun[i - 1]);
        most = std::max(most, begun[i] - begun[i - 1]);
    }
    return {least, most};
}

TEST(CoreBudget, ABudgetThatSufficesLeavesNothingOut) {
    Process process(1.5, 30);
    EXPECT_EQ(process.run(60, 0.04).size(), 1800U);
    EXPECT_NEAR(process.budget().used(), 1.2, 0.02);
}

TEST(CoreBudget, IsKeptByLeavingOutFramesEvenly) {
    for (const double cores : {0.5, 1.0, 1.5, 2.2}) {
        Process process(cores, 30);
        process.run(15, 0.1);  // 3 cores
        const double before = process.used();
        const std::vector<int> begun = process.run(60, 0.1);
        EXPECT_LE(process.used() - before, 60 * cores * 1.02);
        EXPECT_GE(process.used() - before, 60 * cores * 0.97) << "and what is allowed is used";
        EXPECT_NEAR(process.budget().used(), cores, 0.03 * cores);
        const auto [least, most] = gaps_of(begun);
        EXPECT_LE(most - least, 2) << cores;
    }
}

TEST(CoreBudget, WhatTheRestOfTheProcessTakesCounts) {
    Process process(1.0, 30);
    process.run(15, 0.05, 0.4);
    const double before = process.used();
    const std::vector<int> begun = process.run(60, 0.05, 0.4);
    EXPECT_NEAR(process.used() - before, 60, 1.5);
    EXPECT_NEAR(static_cast<double>(begun.size()), 60 * 0.6 / 0.05, 20);
}

TEST(CoreBudget, WhereTheRestTakesAllHardlyAFrameBegins) {
    Process process(0.5, 30);
    process.run(60, 0.05, 0.6);
    EXPECT_LE(process.run(60, 0.05, 0.6).size(), 60U) << "of 1800";
}

// However much the rest of the process took meanwhile, a frame is charged the budget of 2 s at most.
TEST(CoreBudget, FramesAreBackSoonAfterOtherWorkHasEnded) {
    for (const auto& [cores, other] : {std::pair(1.0, 1.2), std::pair(0.5, 4.0), std::pair(2.0, 16.0)}) {
        const double cost = 0.05 * cores;
        Process process(cores, 30);
        process.run(20, cost);
        const std::vector<int> meanwhile = process.run(300, cost, other);
        EXPECT_LE(gaps_of(meanwhile).second, 4.5 * 30) << "at least one in 4 s";
        EXPECT_LE(meanwhile.size(), 300U) << "and no more than one a second";
        const std::vector<int> after = process.run(15, cost);
        ASSERT_FALSE(after.empty());
        EXPECT_LE(after.front() - meanwhile.back(), 4.5 * 30);
        EXPECT_GE(process.run(20, cost).size(), 340U) << "15 s later, of 400 that the budget allows";
        EXPECT_NEAR(process.budget().used(), cores, 0.05 * cores);
    }
}

TEST(CoreBudget, AFrameThatTakesTheBudgetOfSecondsIsRare) {
    Process process(0.25, 30);
    process.run(40, 0.5);
    const double before = process.used();
    process.run(120, 0.5);  // one in 2 s would be 0.25 cores
    EXPECT_NEAR(process.used() - before, 120 * 0.25, 1.5);
}

// Frames that become more expensive are more than the budget for a moment, which is saved afterwards, not all at once.
TEST(CoreBudget, AnExcessIsSavedAndFramesComeMeanwhile) {
    Process process(1.0, 30);
    process.run(20, 0.04);
    const double before = process.used();
    const std::vector<int> begun = process.run(30, 0.12);
    EXPECT_LE(process.used() - before, 30 * 1.05);
    EXPECT_LE(gaps_of(begun).second, 12);
}

TEST(CoreBudget, NothingIsSavedUpInAPause) {
    Process process(1.0, 30);
    process.run(20, 0.1);
    process.pass(3, 0);
    EXPECT_LE(process.run(1, 0.1).size(), 13U) << "10 and the 2 that may be late";
    process.pass(3600, 0.05);
    EXPECT_LE(process.run(1, 0.1).size(), 13U) << "what was spent meanwhile is no frame's cost";
    EXPECT_GE(process.run(9, 0.1).size(), 80U);
}

TEST(CoreBudget, TheWaitOfAReplayEndsWhereItsFrameMayBegin) {
    Process process(1.0, 30);
    process.run(20, 0.1);
    while (process.budget().admits()) {
    }
    const CoreBudget::Seconds wait = process.budget().to_wait();
    EXPECT_GT(wait, 0s);
    EXPECT_LE(wait, 200ms);
    process.pass(wait.count() * 2, 0);  // an excess that is saved may double it
    EXPECT_TRUE(process.budget().admits());
}

TEST(CoreBudget, TheClockOfTheSystemCountsThisProcess) {
    CoreBudget budget(1.0);
    EXPECT_TRUE(budget.admits());
    const auto before = processor_time();
    std::uint64_t sum = 1;
    while (processor_time() - before < 1ms) {
        sum = sum * 6364136223846793005U + 1;
    }
    EXPECT_NE(sum, 0U);
    EXPECT_GT(budget.used(), 0);
}

}  // namespace
}  // namespace disparityd::pipeline
