// SPDX-License-Identifier: Apache-2.0
#include "pipeline/histogram.h"

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

}  // namespace
}  // namespace disparityd::pipeline
