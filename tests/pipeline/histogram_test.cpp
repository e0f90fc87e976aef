// SPDX-License-Identifier: Apache-2.0
#include "pipeline/histogram.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;

TEST(Histogram, EmptyHasZeros) {
    const HistogramSummary summary = Histogram().summary();
    EXPECT_EQ(summary.count, 0U);
    EXPECT_EQ(summary.p99, 0);
    EXPECT_EQ(summary.max, 0);
}

TEST(Histogram, QuantilesAreWithinABucket) {
    Histogram histogram;
    for (int us = 1; us <= 1000; ++us) {
        histogram.record(std::chrono::microseconds(us));
    }
    const HistogramSummary summary = histogram.summary();
    EXPECT_EQ(summary.count, 1000U);
    EXPECT_NEAR(summary.mean, 500.5, 0.01);
    EXPECT_NEAR(summary.p50, 500, 500 * 0.125);
    EXPECT_NEAR(summary.p90, 900, 900 * 0.125);
    EXPECT_NEAR(summary.p99, 990, 990 * 0.125);
    EXPECT_DOUBLE_EQ(summary.max, 1000);
}

TEST(Histogram, TakesExtremes) {
    Histogram histogram;
    histogram.record(0ns);
    histogram.record(-5ns);
    histogram.record(std::chrono::hours(48));
    const HistogramSummary summary = histogram.summary();
    EXPECT_EQ(summary.count, 3U);
    EXPECT_DOUBLE_EQ(summary.max, 48 * 3600e6);
    EXPECT_LE(summary.p99, summary.max);
}

TEST(Histogram, TotalsCountUpToEachBound) {
    Histogram histogram;
    histogram.record(-5ns);
    histogram.record(100us);  // a bound belongs to what it bounds
    histogram.record(100001ns);
    histogram.record(7ms);
    histogram.record(1s);
    histogram.record(1s + 1ns);
    const HistogramTotals totals = histogram.totals();
    EXPECT_EQ(totals.up_to, (std::array<std::uint64_t, 13>{2, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 5}));
    EXPECT_EQ(totals.count, 6U);
    EXPECT_EQ(totals.sum_ns, 100'000U + 100'001U + 7'000'000U + 2'000'000'001U);
}

/// A monitor that saw a count fall would take it for a restart.
TEST(Histogram, TotalsNeverFallWhileTheyAreRead) {
    Histogram histogram;
    std::atomic<bool> done{false};
    std::thread recorder([&] {
        for (int i = 0; i < 200'000; ++i) {
            histogram.record(std::chrono::microseconds(i * 7 % 1'200'000));
        }
        done = true;
    });
    HistogramTotals before;
    while (!done) {
        const HistogramTotals now = histogram.totals();
        for (std::size_t i = 0; i < now.up_to.size(); ++i) {
            ASSERT_GE(now.up_to[i], before.up_to[i]);
            ASSERT_LE(now.up_to[i], now.count);
        }
        ASSERT_TRUE(std::is_sorted(now.up_to.begin(), now.up_to.end()));
        ASSERT_GE(now.sum_ns, before.sum_ns);
        before = now;
    }
    recorder.join();
    EXPECT_EQ(histogram.totals().count, 200'000U);
}

}  // namespace
}  // namespace disparityd::pipeline
