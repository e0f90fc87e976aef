// SPDX-License-Identifier: Apache-2.0
// The reference's steps at noise levels, on what can be computed by hand.
#include <array>
#include <bit>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

Image<std::uint8_t> smoothed(const Image<std::uint8_t>& image) {
    Image<std::uint8_t> result(image.width(), image.height());
    reference::smooth(image.plane(), result.plane(), image.rows());
    return result;
}

TEST(Smooth, HasTheWeightsOneTwoOneBothWays) {
    Image<std::uint8_t> image(5, 5, 0);
    image.at(2, 2) = 160;
    const Image<std::uint8_t> found = smoothed(image);
    EXPECT_EQ(found.pixels(), (std::vector<std::uint8_t>{0,  0, 0, 0,  0,  0,  10, 20, 10, 0, 0, 20, 40,
                                                         20, 0, 0, 10, 20, 10, 0,  0,  0,  0, 0, 0}));
}

TEST(Smooth, RoundsToTheNearestAndReplicatesTheBorder) {
    EXPECT_EQ(smoothed(Image<std::uint8_t>(3, 1, {0, 2, 0})).pixels(), (std::vector<std::uint8_t>{1, 1, 1}));
    EXPECT_EQ(smoothed(Image<std::uint8_t>(3, 1, {0, 1, 0})).pixels(), (std::vector<std::uint8_t>{0, 1, 0}));
    EXPECT_EQ(smoothed(Image<std::uint8_t>(2, 1, {255, 0})).pixels(), (std::vector<std::uint8_t>{191, 64}));
    EXPECT_EQ(smoothed(Image<std::uint8_t>(1, 1, 255)).pixels(), (std::vector<std::uint8_t>{255}));
}

class NoisyCensus : public testing::TestWithParam<int> {
protected:
    // The word of the middle of 7 x 9 pixels.
    std::uint64_t word() const {
        Image<std::uint64_t> words(7, 9, 99);
        reference::noisy_census(image_.plane(), smoothed_.plane(), GetParam(), words.plane(), words.rows());
        return words.at(3, 4);
    }
    std::uint32_t bits() const { return static_cast<std::uint32_t>(word()); }
    int gradient() const { return static_cast<int>(word() >> 32) - 128; }

    Image<std::uint8_t> image_{7, 9, 100};
    Image<std::uint8_t> smoothed_{7, 9, 100};
};

TEST_P(NoisyCensus, ANeighbourMustBeDarkerThanTheSmoothedPixelByMoreThanTheMargin) {
    const int margin = GetParam();
    image_.at(2, 4) = static_cast<std::uint8_t>(100 - margin);
    EXPECT_EQ(bits(), 0U);
    image_.at(2, 4) = static_cast<std::uint8_t>(100 - margin - 1);
    EXPECT_EQ(bits(), 1U << 15);
    image_.at(3, 4) = 0;  // the pixel itself
    EXPECT_EQ(bits(), 1U << 15);
    smoothed_.at(3, 4) = static_cast<std::uint8_t>(margin);  // nothing is darker than black
    image_.at(2, 4) = 0;
    EXPECT_EQ(bits(), 0U);
}

TEST_P(NoisyCensus, ReadsRowsThatLieFartherApart) {
    const int step = GetParam();
    image_.at(1, 4 - 2 * step) = 0;
    EXPECT_EQ(bits(), 1U << 29);
    image_.at(5, 4 + 2 * step) = 0;
    EXPECT_EQ(bits(), (1U << 29) + 1U);
    image_.at(0, 4 - 2 * step) = 0;  // a corner
    EXPECT_EQ(bits(), (1U << 29) + 1U);
    image_.at(0, 4 - step) = 0;
    EXPECT_EQ(bits(), (1U << 29) + (1U << 24) + 1U);
}

TEST_P(NoisyCensus, TheGradientIsThatOfTheSmoothedImageShifted) {
    const int shift = GetParam();
    image_.at(4, 4) = 0;
    EXPECT_EQ(gradient(), 0);
    smoothed_.at(4, 4) = 105;  // 2 * 5
    EXPECT_EQ(gradient(), 10 >> shift);
    smoothed_.at(4, 3) = 99;
    smoothed_.at(2, 4) = 107;  // 10 - 1 - 2 * 7 = -5, rounded down
    EXPECT_EQ(gradient(), shift == 1 ? -3 : -2);
    smoothed_.at(2, 4) = 255;
    EXPECT_EQ(gradient(), -16);
    smoothed_.at(2, 4) = 0;
    EXPECT_EQ(gradient(), 16);
}

TEST_P(NoisyCensus, BorderIsReplicated) {
    const Image<std::uint8_t> dark(1, 1, 10);
    const Image<std::uint8_t> bright(1, 1, 200);
    Image<std::uint64_t> word(1, 1);
    reference::noisy_census(dark.plane(), bright.plane(), GetParam(), word.plane(), word.rows());
    EXPECT_EQ(word.at(0, 0), (std::uint64_t{128} << 32) + 0x3fffffff);
}

INSTANTIATE_TEST_SUITE_P(Coarseness, NoisyCensus, testing::Values(1, 2));

constexpr std::int16_t rejected = -16;

Image<std::int16_t> voted(const Image<std::int16_t>& in) {
    Image<std::int16_t> out(in.width(), in.height());
    reference::vote(in.plane(), rejected, out.plane(), out.rows());
    return out;
}

// What is left of 100 in the middle of 5 x 5 pixels, `agreeing` of which have `value` and the others none.
int middle_among(int agreeing, std::int16_t value) {
    Image<std::int16_t> image(5, 5, rejected);
    image.at(2, 2) = 100;
    int set = 0;
    for (std::int16_t& pixel : image.pixels()) {
        if (pixel == rejected && set < agreeing) {
            pixel = value;
            ++set;
        }
    }
    return voted(image).at(2, 2);
}

TEST(Vote, WantsTwelveOthersOfAWholeWindow) {
    EXPECT_EQ(middle_among(12, 100), 100);
    EXPECT_EQ(middle_among(11, 100), rejected);
    EXPECT_EQ(middle_among(0, 100), rejected);
}

TEST(Vote, CountsWhatDiffersByAtMostOneAndAHalfPixels) {
    EXPECT_EQ(middle_among(24, 124), 100 + 23);  // 24 * 24 / 25, rounded
    EXPECT_EQ(middle_among(24, 76), 100 - 23);
    EXPECT_EQ(middle_among(24, 125), rejected);
    EXPECT_EQ(middle_among(24, 75), rejected);
}

TEST(Vote, GivesTheMeanHalvesRoundedUp) {
    Image<std::int16_t> image(2, 1, {10, 11});
    EXPECT_EQ(voted(image).pixels(), (std::vector<std::int16_t>{11, 11}));
    image = {2, 1, {-10, -11}};
    EXPECT_EQ(voted(image).pixels(), (std::vector<std::int16_t>{-10, -10}));
    image = {3, 1, {0, 0, 1}};
    EXPECT_EQ(voted(image).pixels(), (std::vector<std::int16_t>{0, 0, 0}));
}

TEST(Vote, AtTheBorderTheWindowIsWhatLiesInside) {
    EXPECT_EQ(voted(Image<std::int16_t>(1, 1, 77)).pixels(), (std::vector<std::int16_t>{77}));
    // 5 of 9 in the corner are enough, 4 are not.
    Image<std::int16_t> corner(3, 3, {0, 0, rejected, 0, 0, rejected, 0, rejected, rejected});
    EXPECT_EQ(voted(corner).at(0, 0), 0);
    corner.at(0, 2) = rejected;
    EXPECT_EQ(voted(corner).at(0, 0), rejected);
}

TEST(Vote, WhatIsRejectedStaysSoAndDoesNotCount) {
    // The rejected value is near: 16/16 px below 0.
    Image<std::int16_t> image(5, 5, 0);
    image.at(0, 0) = rejected;
    const Image<std::int16_t> found = voted(image);
    EXPECT_EQ(found.at(0, 0), rejected);
    EXPECT_EQ(found.at(1, 1), 0);
}

}  // namespace
}  // namespace disparityd::test
