// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_estimate.h"

#include <gtest/gtest.h>

#include "kernels/noise/noise_level_switch.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

// A pair whose eyes see the same grey, but for a chessboard of `step` more and less in the right one: the difference
// has the variance step^2, one eye's noise the variance step^2 / 2.
struct Chessboard {
    Chessboard(int width, int height)
        : left(width, height, 100),
          right(width, height, 100),
          disparity(width, height),
          confidence(width, height, 200) {}

    void set_block(int column, int row, int step) {
        for (int y = 8 * row; y < 8 * row + 8; ++y) {
            for (int x = 8 * column; x < 8 * column + 8; ++x) {
                right.at(x, y) = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 100 + step : 100 - step);
            }
        }
    }

    NoiseEstimate estimate() const {
        return estimate_noise(left.plane(), right.plane(), disparity.plane(), confidence.plane());
    }

    Image<std::uint8_t> left, right;
    Image<std::int16_t> disparity;
    Image<std::uint8_t> confidence;
};

TEST(NoiseEstimate, IsTheSpreadOfTheDifferenceOfBothEyesOverTheRootOfTwo) {
    Chessboard pair(8, 8);
    for (const auto& [step, sigma256] : {std::pair{0, 0}, {1, 181}, {2, 362}, {10, 1810}}) {
        pair.set_block(0, 0, step);
        EXPECT_EQ(pair.estimate().sigma256, sigma256) << step;
        EXPECT_EQ(pair.estimate().blocks, 1);
    }
}

TEST(NoiseEstimate, OfADarkPictureIsThatOfABrighterOne) {
    for (const auto& [grey, sigma256] : {std::pair{100, 362}, {64, 362}, {32, 724}, {16, 1448}}) {
        Chessboard pair(8, 8);
        pair.set_block(0, 0, 2);
        pair.left = Image<std::uint8_t>(8, 8, static_cast<std::uint8_t>(grey));
        EXPECT_EQ(pair.estimate().sigma256, sigma256) << grey;
    }
}

TEST(NoiseEstimate, ADifferenceOfBrightnessIsNoNoise) {
    Chessboard pair(8, 8);
    pair.left = Image<std::uint8_t>(8, 8, 140);
    EXPECT_EQ(pair.estimate().sigma256, 0);
}

TEST(NoiseEstimate, ComparesEachPixelWithItsMatchToTheNearestPixel) {
    Random random(61);
    const Image<std::uint8_t> left = noise(random, 64, 16, 1, 254);
    for (const auto& [d16, d] : {std::pair{0, 0}, {80, 5}, {87, 5}, {88, 6}, {-80, -5}, {-73, -5}, {-72, -4}}) {
        const Image<std::uint8_t> right = shifted(random, left, d);
        const Image<std::int16_t> disparity(64, 16, static_cast<std::int16_t>(d16));
        Image<std::uint8_t> confidence(64, 16);
        for (int y = 0; y < 16; ++y) {
            for (int x = 8; x < 56; ++x) {
                confidence.at(x, y) = 1;
            }
        }
        const NoiseEstimate found = estimate_noise(left.plane(), right.plane(), disparity.plane(), confidence.plane());
        EXPECT_EQ(found.sigma256, 0) << d16;
        EXPECT_EQ(found.blocks, 12) << d16;
    }
}

TEST(NoiseEstimate, ABlockCountsFrom48MeasuredPixelsOn) {
    Chessboard pair(16, 8);
    for (int i = 0; i < 16; ++i) {
        pair.confidence.at(i % 8, i / 8) = 0;
        EXPECT_EQ(pair.estimate().blocks, 2);
    }
    pair.confidence.at(0, 2) = 0;
    EXPECT_EQ(pair.estimate().blocks, 1);
}

TEST(NoiseEstimate, BlocksThatMayBeClippedDoNotCount) {
    for (const std::uint8_t grey : {std::uint8_t{0}, std::uint8_t{255}}) {
        Chessboard pair(24, 8);
        pair.left.at(3, 3) = grey;
        pair.right.at(9, 7) = grey;
        EXPECT_EQ(pair.estimate().blocks, 1);
    }
}

TEST(NoiseEstimate, IsTheFifthPercentileOfTheBlocks) {
    Chessboard pair(80, 80);
    for (int i = 0; i < 100; ++i) {
        pair.set_block(i % 10, i / 10, i < 95 ? 20 : i - 94);
    }
    EXPECT_EQ(pair.estimate().blocks, 100);
    EXPECT_EQ(pair.estimate().sigma256, 3620);
    pair.set_block(0, 0, 6);
    EXPECT_EQ(pair.estimate().sigma256, 1086) << "6 / sqrt(2), the sixth smallest";
}

TEST(NoiseEstimate, TakesBlocksAtEqualDistancesOfALargeImage) {
    EXPECT_EQ(Chessboard(8 * 32, 8 * 32).estimate().blocks, 1024);
    EXPECT_EQ(Chessboard(8 * 33, 8 * 32).estimate().blocks, 17 * 16);
    EXPECT_EQ(Chessboard(1280, 720).estimate().blocks, 40 * 23);
}

TEST(NoiseEstimate, OfNothingIsOfNoBlocks) {
    EXPECT_EQ(Chessboard(7, 100).estimate().blocks, 0);
    EXPECT_EQ(Chessboard(1, 1).estimate().blocks, 0);
}

TEST(NoiseEstimate, MatchesBeyondTheImageAreReadAtItsBorder) {
    Random random(62);
    for (const int d16 : {-32768, -5000, 5000, 32767}) {
        const Image<std::uint8_t> grey = noise(random, 24, 16, 1, 254);
        const Image<std::int16_t> disparity(24, 16, static_cast<std::int16_t>(d16));
        const Image<std::uint8_t> confidence(24, 16, 1);
        EXPECT_EQ(estimate_noise(grey.plane(), grey.plane(), disparity.plane(), confidence.plane()).blocks, 6);
    }
}

NoiseEstimate of(double sigma) {
    return {static_cast<int>(sigma * 256), 100};
}

TEST(NoiseLevelSwitch, GoesUpAtOnceAsFarAsNeeded) {
    for (const auto& [sigma, level] :
         {std::pair{0.0, 0}, {1.74, 0}, {1.75, 1}, {2.19, 1}, {2.2, 2}, {3.19, 2}, {3.2, 3}, {60.0, 3}}) {
        NoiseLevelSwitch one;
        EXPECT_EQ(one.level(), 0);
        one.add(of(sigma));
        EXPECT_EQ(one.level(), level) << sigma;
    }
}

TEST(NoiseLevelSwitch, GoesDownWhenTenFramesInARowHadClearlyLess) {
    NoiseLevelSwitch one;
    one.add(of(2.3));
    for (int frame = 0; frame < 9; ++frame) {
        one.add(of(1.6));
        EXPECT_EQ(one.level(), 2);
    }
    one.add(of(1.93));  // seven eighths of 2.2
    for (int frame = 0; frame < 9; ++frame) {
        one.add(of(1.6));
        EXPECT_EQ(one.level(), 2);
    }
    one.add(of(1.6));
    EXPECT_EQ(one.level(), 1);
}

TEST(NoiseLevelSwitch, GoesDownAsFarAsTheNoiseDoes) {
    NoiseLevelSwitch one;
    one.add(of(5));
    EXPECT_EQ(one.level(), 3);
    for (int frame = 0; frame < 10; ++frame) {
        one.add(of(0.5));
    }
    EXPECT_EQ(one.level(), 0);
}

TEST(NoiseLevelSwitch, StaysWhereTheNoiseIsAtALimit) {
    NoiseLevelSwitch one;
    one.add(of(1.75));
    for (int frame = 0; frame < 100; ++frame) {
        one.add(of(frame % 2 == 0 ? 1.6 : 1.9));
        EXPECT_EQ(one.level(), 1);
    }
}

TEST(NoiseLevelSwitch, TooFewBlocksTellNothing) {
    NoiseLevelSwitch one;
    one.add({1000, 7});
    EXPECT_EQ(one.level(), 0);
    one.add({1000, 8});
    EXPECT_EQ(one.level(), 3);
    for (int frame = 0; frame < 20; ++frame) {
        one.add({0, 7});
    }
    EXPECT_EQ(one.level(), 3);
}

TEST(NoiseLevelSwitch, BeginsAnewAfterADiscontinuity) {
    NoiseLevelSwitch one;
    one.add(of(3));
    one.restart();
    EXPECT_EQ(one.level(), 0);
}

}  // namespace
}  // namespace disparityd::test
