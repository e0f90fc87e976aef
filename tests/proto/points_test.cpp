// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "clients/cpp/disparity_client.hpp"

namespace disparity {
namespace {

constexpr std::int16_t rejected = -16;

template <typename T>
PlaneData plane_of(Product product, const std::vector<T>& values) {
    PlaneData plane{product, 5, 3, sizeof(T), std::vector<std::uint8_t>(values.size() * sizeof(T))};
    std::memcpy(plane.bytes.data(), values.data(), plane.bytes.size());
    return plane;
}

/// 5 x 3 pixels, three of them measured: at 10, 20 and 30 px. Each has its index for a grey level.
Frame frame_of_three() {
    Frame frame;
    frame.f = 100;
    frame.cx = 2;
    frame.cy = 1;
    frame.baseline_mm = 120;
    frame.invalid = rejected;
    std::vector<std::int16_t> disparities(15, rejected);
    disparities[1] = 160;
    disparities[5] = 320;
    disparities[14] = 480;
    std::vector<std::uint8_t> grey(15);
    for (std::size_t i = 0; i < grey.size(); ++i) {
        grey[i] = static_cast<std::uint8_t>(i);
    }
    frame.planes = {plane_of(Product::disparity, disparities), plane_of(Product::left, grey)};
    return frame;
}

TEST(ThinnedPoints, AreTheNearestOfEachBlock) {
    const Points points = frame_of_three().points(2).value();
    ASSERT_EQ(points.width, 3U);
    ASSERT_EQ(points.height, 2U);
    EXPECT_FLOAT_EQ(points.points[0].z, 0.6F) << "12 m px / 20 px, not 10";
    EXPECT_FLOAT_EQ(points.points[0].x, -2 * 0.6F / 100) << "where that pixel is: column 0, row 1";
    EXPECT_FLOAT_EQ(points.points[0].y, 0);
    EXPECT_EQ(points.points[0].red, 5);
    EXPECT_FLOAT_EQ(points.points[5].z, 0.4F);
    for (const std::size_t block : {1U, 2U, 3U, 4U}) {
        EXPECT_TRUE(std::isnan(points.points[block].z)) << block;
    }
    EXPECT_EQ(points.points[4].red, 12) << "a block without a point has its first pixel's colour";
}

TEST(ThinnedPoints, OfOneBlockThatIsLargerThanTheImage) {
    const Points points = frame_of_three().points(100000).value();
    ASSERT_EQ(points.points.size(), 1U);
    EXPECT_FLOAT_EQ(points.points[0].z, 0.4F);
    EXPECT_EQ(points.points[0].red, 14);
}

TEST(ThinnedPoints, AFlatSurfaceKeepsTheFirstOfABlock) {
    Frame frame = frame_of_three();
    frame.planes[0] = plane_of(Product::disparity, std::vector<std::int16_t>(15, 160));
    const Points points = frame.points(2).value();
    EXPECT_EQ(points.points[4].red, 12);
}

}  // namespace
}  // namespace disparity
