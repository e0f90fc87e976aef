// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/confidence/reliability.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::eval {
namespace {

/// Pixels in a row, the truth of which is 10 px.
Reliability counted(const std::vector<float>& disparities, const std::vector<std::uint8_t>& confidence) {
    const auto width = static_cast<int>(disparities.size());
    Reliability result;
    result.add({width, 1, disparities}, confidence, {width, 1, std::vector<float>(disparities.size(), 10)});
    return result;
}

TEST(Reliability, CountsWhatIsRightForEachConfidence) {
    // Off by 1 is right, by more is wrong; rejected pixels (confidence 0) do not count.
    const Reliability of = counted({10, 11, 11.5, 9, 30, 0}, {100, 100, 100, 200, 200, 0});
    EXPECT_DOUBLE_EQ(of.weight[100], 0.6);
    EXPECT_DOUBLE_EQ(of.right[100], 0.4);
    EXPECT_DOUBLE_EQ(of.weight[200], 0.4);
    EXPECT_DOUBLE_EQ(of.right[200], 0.2);
    const std::vector<ReliabilityBin> bins = reliability_bins(of);
    ASSERT_EQ(bins.size(), 16U);
    EXPECT_EQ(bins[6].first, 96);
    EXPECT_EQ(bins[6].last, 111);
    EXPECT_DOUBLE_EQ(bins[6].share, 0.6);
    EXPECT_DOUBLE_EQ(bins[6].says, 100 / 255.0);
    EXPECT_DOUBLE_EQ(bins[6].is, 2 / 3.0);
    EXPECT_TRUE(std::isnan(bins[0].is));
    EXPECT_NEAR(calibration_error(of), 0.6 * (2 / 3.0 - 100 / 255.0) + 0.4 * (200 / 255.0 - 0.5), 1e-12);
}

TEST(Reliability, EachSceneCountsTheSame) {
    Reliability all = counted({10, 10, 10, 10}, {8, 8, 8, 8});
    all.add(counted({20}, {8}));
    EXPECT_DOUBLE_EQ(all.weight[8], 2);
    EXPECT_DOUBLE_EQ(all.right[8], 1);
}

TEST(Reliability, UnknownTruthDoesNotCount) {
    Reliability of;
    of.add({2, 1, {10, 10}}, {50, 50}, {2, 1, {std::numeric_limits<float>::infinity(), 30}});
    EXPECT_DOUBLE_EQ(of.weight[50], 1);
    EXPECT_DOUBLE_EQ(of.right[50], 0);
    EXPECT_THROW(of.add({2, 1, {10, 10}}, {50}, {2, 1, {10, 10}}), std::invalid_argument);
}

TEST(Reliability, WithoutPixelsNothingIsKnown) {
    EXPECT_TRUE(std::isnan(calibration_error({})));
    EXPECT_TRUE(std::isnan(sparsification_area({})));
}

// Half of the pixels are wrong. Removed first, 0 is left of them once half is gone; in an order that knows nothing the
// share of wrong pixels stays 1/2; removed last, it grows to 1. The best order has (1/2 - f) / (1 - f) up to f = 1/2,
// and its area is 1/2 - ln(2) / 2.
TEST(Reliability, SparsificationAreaIsThatBetweenTheOrderAndTheBestOne) {
    const double best = 0.5 - std::log(2.0) / 2;
    EXPECT_NEAR(sparsification_area(counted({10, 20}, {200, 100})), 0, 1e-3);
    EXPECT_NEAR(sparsification_area(counted({10, 20}, {100, 100})), 0.5 - best, 2e-3);
    // 1 / 2 / (1 - f) up to f = 1/2, then 1: ln(2) / 2 + 1/2.
    EXPECT_NEAR(sparsification_area(counted({10, 20}, {100, 200})), std::log(2.0) / 2 + 0.5 - best, 2e-3);
}

}  // namespace
}  // namespace disparityd::eval
