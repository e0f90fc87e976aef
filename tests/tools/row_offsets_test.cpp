// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/row_offsets.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace disparityd::tools {
namespace {

using calibration::CornerMatch;

/// Corners of a camera that is turned: the offset is 0.3 px in the middle and changes by a pixel over the image. Every
/// `wrong_each`th is another corner, some rows away.
std::vector<CornerMatch> turned_camera(int count, int wrong_each) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(0, 1280);
    std::uniform_real_distribution<double> y(0, 720);
    std::normal_distribution<double> noise(0, 0.05);
    std::uniform_real_distribution<double> far(3, 8);
    std::vector<CornerMatch> matches;
    for (int i = 0; i < count; ++i) {
        CornerMatch match{x(random), y(random), 0, 0};
        match.right_x = match.left_x - 30;
        const double offset = 0.3 + (match.left_x - 640) / 1280 + noise(random);
        const bool wrong = i % wrong_each == wrong_each - 1;
        match.right_y = match.left_y - offset - (wrong ? std::copysign(far(random), i % 3 - 0.5) : 0);
        matches.push_back(match);
    }
    return matches;
}

TEST(RowOffsetsTest, WrongMatchesAreLeftOutAndCounted) {
    const RowOffsets clean = row_offsets(turned_camera(400, 1000));
    EXPECT_EQ(clean.agreeing.size(), 400U) << "what a turned camera does is no wrong match";
    EXPECT_EQ(clean.wrong, 0);
    const RowOffsets mixed = row_offsets(turned_camera(400, 4));
    EXPECT_NEAR(mixed.wrong, 0.25, 1e-9);
    EXPECT_EQ(mixed.agreeing.size(), 300U);
    EXPECT_NEAR(mixed.median, clean.median, 0.05);
    for (const CornerMatch& match : mixed.agreeing) {
        EXPECT_LT(std::abs(match.left_y - match.right_y), 1.5);
    }
}

TEST(RowOffsetsTest, FewOrEqualMatchesAllAgree) {
    EXPECT_EQ(row_offsets({}).median, 0);
    const std::vector<CornerMatch> few{{10, 10, 5, 9}, {20, 20, 15, 10}};
    EXPECT_EQ(row_offsets(few).agreeing.size(), 2U);
    EXPECT_DOUBLE_EQ(row_offsets(few).median, 5.5);
    const std::vector<CornerMatch> same(20, CornerMatch{10, 10, 5, 12});
    EXPECT_EQ(row_offsets(same).agreeing.size(), 20U);
    EXPECT_DOUBLE_EQ(row_offsets(same).median, 2);
}

}  // namespace
}  // namespace disparityd::tools
