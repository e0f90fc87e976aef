// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/epipolar_fit.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "capture/scene/scene_camera.h"

namespace disparityd::calibration {
namespace {

constexpr double f = 350;
constexpr int blocks = 48;

/// Points of the room as a camera sees them whose right eye has changed since `factory` was measured.
std::vector<RayPair> seen(const StereoCalibration& factory, const Parameters& change, double noise_px, double outliers,
                          std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double least, double most) {
        return least + (most - least) * (static_cast<double>(random()) / 4294967296.0);
    };
    cv::Matx33d turn;
    cv::Rodrigues(cv::Vec3d(change[pitch], change[yaw], change[roll]), turn);
    const cv::Matx33d rotation = turn * cv::Matx33d(factory.rotation.data());
    std::vector<RayPair> pairs;
    for (int i = 0; i < 900; ++i) {
        const double x = uniform(-0.9, 0.9);
        const double y = uniform(-0.5, 0.5);
        const double z = std::exp(uniform(std::log(800), std::log(20000)));
        const cv::Vec3d right = rotation * cv::Vec3d(x * z, y * z, z) + cv::Vec3d(factory.translation.data());
        const double noise = uniform(-noise_px, noise_px) + (uniform(0, 1) < outliers ? uniform(-8, 8) : 0);
        const double grown = 1 + change[focal];
        const int block = static_cast<int>((x + 0.9) / 1.8 * 8) + 8 * static_cast<int>((y + 0.5) * 6);
        pairs.push_back({x, y, grown * right[0] / right[2], grown * right[1] / right[2] + noise / f, block});
    }
    return pairs;
}

StereoCalibration factory() {
    return capture::scene_calibration(672, 376);
}

TEST(VerticalError, IsTheDifferenceOfTheRowsWithItsSign) {
    const Parameters change{0.002, 0, 0, 0};
    const auto pairs = seen(factory(), change, 0, 0, 1);
    const VerticalError wrong(factory(), f, {});
    const VerticalError right(factory(), f, change);
    for (const RayPair& pair : pairs) {
        EXPECT_NEAR(right(pair), 0, 1e-6);
        // A camera that looks further down sees the room further up: left y - right y = 0.002 f (1 + y^2).
        EXPECT_NEAR(wrong(pair), 0.002 * f * (1 + pair.left_y * pair.left_y), 0.03);
    }
}

TEST(VerticalError, SlopesAreThoseOfTheError) {
    const Parameters change{0.003, -0.002, 0.004, 0.001};
    const auto pairs = seen(factory(), change, 1, 0, 2);
    constexpr double step = 1e-6;
    for (std::size_t i = 0; i < pairs.size(); i += 50) {
        Parameters slopes{};
        VerticalError(factory(), f, change).with_slopes(pairs[i], slopes);
        for (std::size_t p = 0; p < parameters; ++p) {
            Parameters more = change;
            Parameters less = change;
            more[p] += step;
            less[p] -= step;
            const double measured =
                (VerticalError(factory(), f, more)(pairs[i]) - VerticalError(factory(), f, less)(pairs[i])) /
                (2 * step);
            EXPECT_NEAR(slopes[p], measured, 0.02 * f) << "parameter " << p;
        }
    }
}

TEST(EpipolarFit, FindsAllFourParametersOfPerfectRays) {
    const Parameters change{0.004, -0.003, 0.005, 0.002};
    const EpipolarFit fit = fit_epipolar(factory(), f, seen(factory(), change, 0, 0, 3), blocks);
    ASSERT_TRUE(fit.solved);
    EXPECT_NEAR(fit.change[pitch], change[pitch], 1e-5);
    EXPECT_NEAR(fit.change[roll], change[roll], 1e-5);
    EXPECT_NEAR(fit.change[yaw], change[yaw], 1e-4);
    EXPECT_NEAR(fit.change[focal], change[focal], 1e-4);
    EXPECT_EQ(fit.blocks_used, blocks);
}

TEST(EpipolarFit, AThirdOfOutliersDoesNotMoveIt) {
    const Parameters change{-0.003, 0, 0.004, 0};
    const EpipolarFit fit = fit_epipolar(factory(), f, seen(factory(), change, 0.3, 0.33, 4), blocks);
    ASSERT_TRUE(fit.solved);
    EXPECT_NEAR(fit.change[pitch] * f, change[pitch] * f, 0.05);
    EXPECT_NEAR(fit.change[roll] * f, change[roll] * f, 0.05);
    EXPECT_LT(fit.inliers, 0.9);
    EXPECT_GT(fit.inliers, 0.6);
}

// Over many draws, errors are as large as the deviations say: neither boast nor modesty.
TEST(EpipolarFit, DeviationsTellHowFarOffItIs) {
    const Parameters change{0.001, 0, -0.002, 0};
    Parameters squares{};
    constexpr int draws = 60;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const EpipolarFit fit = fit_epipolar(factory(), f, seen(factory(), change, 0.5, 0.1, 100 + i), blocks);
        ASSERT_TRUE(fit.solved);
        for (const Parameter p : {pitch, roll}) {
            squares[p] += std::pow((fit.change[p] - change[p]) / fit.deviation[p], 2) / draws;
        }
    }
    for (const Parameter p : {pitch, roll}) {
        EXPECT_GT(squares[p], 0.4);
        EXPECT_LT(squares[p], 2.5);
    }
}

TEST(EpipolarFit, WhatIsFixedStaysZero) {
    const auto pairs = seen(factory(), {0.004, 0.001, 0.005, 0.002}, 0.1, 0, 5);
    const EpipolarFit fit = fit_epipolar(factory(), f, pairs, blocks, {false, true, false, true});
    ASSERT_TRUE(fit.solved);
    EXPECT_EQ(fit.change[yaw], 0);
    EXPECT_EQ(fit.change[focal], 0);
    EXPECT_NEAR(fit.change[pitch], 0.004, 3e-4);
}

TEST(EpipolarFit, SaysWhenThereIsTooLittle) {
    EXPECT_FALSE(fit_epipolar(factory(), f, {}, blocks).solved);
    auto pairs = seen(factory(), {}, 0.1, 0, 6);
    for (RayPair& pair : pairs) {
        pair.block = 0;
    }
    EXPECT_FALSE(fit_epipolar(factory(), f, pairs, blocks).solved);
    const std::vector<RayPair> same(50, pairs[0]);
    EXPECT_FALSE(fit_epipolar(factory(), f, same, blocks).solved);
}

TEST(Median, OfOddEvenAndNone) {
    EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2);
    EXPECT_EQ(median(std::vector<double>{4, 1, 3, 2}), 2.5);
    EXPECT_EQ(median({}), 0);
}

}  // namespace
}  // namespace disparityd::calibration
