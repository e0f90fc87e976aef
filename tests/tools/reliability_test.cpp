// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/confidence/reliability.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tools/eval/confidence/error_spread.h"

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

/// Errors of pixels in a row, the truth of which is 10 px.
ErrorSpread spread(const std::vector<float>& disparities, const std::vector<std::uint8_t>& confidence) {
    const auto width = static_cast<int>(disparities.size());
    ErrorSpread result;
    result.add({width, 1, disparities}, confidence, {width, 1, std::vector<float>(disparities.size(), 10)});
    return result;
}

TEST(ErrorSpread, SigmaOfANormalDistributionIsItsOwn) {
    std::mt19937 random(5);
    for (const float wanted : {0.1F, 0.25F, 0.3F}) {
        std::normal_distribution<float> error(0, wanted);
        std::vector<float> disparities(20000);
        for (float& disparity : disparities) {
            disparity = std::round(16 * (10 + error(random))) / 16;  // as disparities come
        }
        const ErrorSpread of = spread(disparities, std::vector<std::uint8_t>(disparities.size(), 250));
        EXPECT_NEAR(of.sigma_px(), wanted, 0.02);
        EXPECT_NEAR(of.sigma_px(15), wanted, 0.02);
        EXPECT_NEAR(of.quantile_px(0.683), wanted, 0.02);
        EXPECT_NEAR(of.quantile_px(0.954), 2 * wanted, 0.03);
        EXPECT_TRUE(std::isnan(of.sigma_px(14)));
    }
}

TEST(ErrorSpread, WrongMatchesAndUnknownPixelsDoNotCount) {
    const ErrorSpread of = spread({10.25, 9.75, 11, 30, 15, NAN}, {100, 100, 100, 100, 0, 100});
    EXPECT_DOUBLE_EQ(of.sigma_px(), 1.4826 * 0.25);  // the middle of a cell of 1/16 px
    EXPECT_DOUBLE_EQ(of.sigma_px(6), of.sigma_px());
    EXPECT_TRUE(std::isnan(spread({11}, {9}).sigma_px()));
    EXPECT_TRUE(std::isnan(ErrorSpread().quantile_px(0.5)));
    EXPECT_THROW(ErrorSpread().add({1, 1, {10}}, {}, {1, 1, {10}}), std::invalid_argument);
}

TEST(ErrorSpread, EachSceneCountsTheSame) {
    ErrorSpread all = spread({10, 10, 10, 10, 10}, {8, 8, 8, 8, 8});
    all.add(spread({10.5}, {8}));
    all.add(spread({10.5}, {8}));
    EXPECT_GT(all.quantile_px(0.5), 0.4);
    EXPECT_LT(all.quantile_px(0.3), 0.1);
}

}  // namespace
}  // namespace disparityd::eval
