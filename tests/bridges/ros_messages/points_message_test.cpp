// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "bridges/ros_messages/point_cloud_message.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::Product;
using test::CdrReader;

struct Cloud {
    std::uint32_t height = 0;
    std::uint32_t width = 0;
    std::vector<std::string> fields;
    std::uint32_t point_bytes = 0;
    std::vector<std::uint8_t> data;
    bool dense = false;

    float value(std::size_t point, std::size_t field) const {
        float number{};
        std::memcpy(&number, &data.at(point * point_bytes + 4 * field), sizeof number);
        return number;
    }
};

Cloud cloud_in(const std::optional<std::string>& message) {
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), "1700000000.123456789 left_camera");
    Cloud cloud;
    cloud.height = cdr.get<std::uint32_t>();
    cloud.width = cdr.get<std::uint32_t>();
    const auto fields = cdr.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < fields; ++i) {
        cloud.fields.emplace_back(cdr.text());
        EXPECT_EQ(cdr.get<std::uint32_t>(), 4 * i) << "offset";
        EXPECT_EQ(cdr.get<std::uint8_t>(), 7) << "FLOAT32";
        EXPECT_EQ(cdr.get<std::uint32_t>(), 1U) << "count";
    }
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "little endian";
    cloud.point_bytes = cdr.get<std::uint32_t>();
    EXPECT_EQ(cdr.get<std::uint32_t>(), cloud.point_bytes * cloud.width) << "row_step";
    cloud.data = cdr.sequence<std::uint8_t>();
    EXPECT_EQ(cloud.data.size(), std::size_t{cloud.point_bytes} * cloud.width * cloud.height);
    cloud.dense = cdr.get<std::uint8_t>() == 1;
    EXPECT_EQ(cdr.left(), 0U);
    return cloud;
}

const CloudSettings all{.most_points = 1000};

TEST(RosPoints, APointLiesWhereItsPixelShowsIt) {
    const Cloud cloud = cloud_in(point_cloud(test::grey_frame(), all));
    EXPECT_EQ(cloud.fields, (std::vector<std::string>{"x", "y", "z", "intensity"}));
    EXPECT_EQ(cloud.width, 8U);
    EXPECT_EQ(cloud.height, 4U);
    // Pixel 19 is at (3, 2) with 16 * 19 + 3 sixteenths of a pixel.
    const float z = 12 / (19.1875F + 0.25F);
    EXPECT_FLOAT_EQ(cloud.value(19, 0), (3 - 3.5F) * z / 100);
    EXPECT_FLOAT_EQ(cloud.value(19, 1), (2 - 1.5F) * z / 100);
    EXPECT_FLOAT_EQ(cloud.value(19, 2), z);
    EXPECT_EQ(cloud.value(19, 3), 133) << "7 * 19";
}

TEST(RosPoints, WhatHasNoPlaceIsNan) {
    const Cloud cloud = cloud_in(point_cloud(test::grey_frame(), all));
    for (const std::size_t pixel : {0U, 1U}) {  // rejected, too far
        for (const std::size_t field : {0U, 1U, 2U}) {
            EXPECT_TRUE(std::isnan(cloud.value(pixel, field))) << pixel;
        }
    }
}

TEST(RosPoints, AColourIsPackedIntoAFloat) {
    const Cloud cloud = cloud_in(point_cloud(test::colour_frame(), all));
    EXPECT_EQ(cloud.fields.back(), "rgb");
    std::uint32_t packed = 0;
    std::memcpy(&packed, &cloud.data.at(16 * 5 + 12), sizeof packed);
    EXPECT_EQ(packed, 250U << 16 | 10U << 8 | 5U);
}

TEST(RosPoints, WithoutDisparitiesTheyComeFromDepths) {
    Frame frame = test::grey_frame();
    std::erase_if(frame.planes, [](const auto& plane) {
        return plane.product == Product::disparity || plane.product == Product::left;
    });
    const Cloud cloud = cloud_in(point_cloud(frame, all));
    EXPECT_EQ(cloud.fields, (std::vector<std::string>{"x", "y", "z"}));
    EXPECT_EQ(cloud.value(19, 2), 1.019F);
}

TEST(RosPoints, ARegionKeepsItsPlace) {
    Frame frame = test::grey_frame();
    const float x = cloud_in(point_cloud(frame, all)).value(19, 0);
    frame.region_x = 50;
    const Cloud cloud = cloud_in(point_cloud(frame, all));
    EXPECT_FLOAT_EQ(cloud.value(19, 0), x + 50 * cloud.value(19, 2) / 100);
}

TEST(RosPoints, ALargeCloudIsThinned) {
    const Cloud whole = cloud_in(point_cloud(test::grey_frame(), {.most_points = 32}));
    EXPECT_EQ(whole.width * whole.height, 32U);
    const Cloud thinned = cloud_in(point_cloud(test::grey_frame(), {.most_points = 31}));  // 8 x 4 by 2
    EXPECT_EQ(thinned.width, 4U);
    EXPECT_EQ(thinned.height, 2U);
    for (const std::size_t field : {0U, 1U, 2U, 3U}) {
        EXPECT_EQ(thinned.value(5, field), whole.value(27, field)) << "the nearest of pixels 18, 19, 26, 27";
        EXPECT_EQ(thinned.value(0, field), whole.value(9, field)) << "0 is rejected, 1 too far, 9 nearer than 8";
    }
    const Cloud odd = cloud_in(point_cloud(test::grey_frame(), {.most_points = 7}));  // by 3: 3 columns, 2 rows
    EXPECT_EQ(odd.width, 3U);
    EXPECT_EQ(odd.height, 2U);
    EXPECT_EQ(odd.value(5, 3), 217) << "of columns 6 and 7, row 3, pixel 31 is nearest";
    EXPECT_EQ(cloud_in(point_cloud(test::grey_frame(), {.most_points = 0})).data.size(), 16U);
}

TEST(RosPoints, ThereAreNoneWithoutACalibration) {
    Frame frame = test::grey_frame();
    frame.f = 0;
    EXPECT_FALSE(point_cloud(frame, all));
    EXPECT_FALSE(point_cloud(test::bare_frame(), all));
}

TEST(RosPoints, APackedCloudHasNothingWithoutAPlace) {
    const Cloud whole = cloud_in(point_cloud(test::grey_frame(), all));
    EXPECT_FALSE(whole.dense);
    const Cloud cloud = cloud_in(point_cloud(test::grey_frame(), {.packed = true}));
    EXPECT_TRUE(cloud.dense);
    EXPECT_EQ(cloud.height, 1U);
    ASSERT_EQ(cloud.width, 30U) << "but for a rejected pixel and one that is too far";
    for (std::size_t i = 0; i < 30; ++i) {
        for (std::size_t field = 0; field < 4; ++field) {
            EXPECT_EQ(cloud.value(i, field), whole.value(i + 2, field));
        }
    }
}

TEST(RosPoints, ABoxIsInTheRobotsDirections) {
    CloudSettings settings{.most_points = 1000, .box = CloudBox{0, 100, -100, 100, -100, 0}};
    EXPECT_EQ(cloud_in(point_cloud(test::grey_frame(), settings)).width, 16U) << "below the camera: the lower two rows";
    settings.box = CloudBox{0, 100, 0, 100, -100, 100};
    EXPECT_EQ(cloud_in(point_cloud(test::grey_frame(), settings)).width, 14U) << "to the left, of 4 columns";
    settings.box = CloudBox{0, 0.5, -100, 100, -100, 100};
    const Cloud near = cloud_in(point_cloud(test::grey_frame(), settings));
    EXPECT_EQ(near.width, 8U) << "12 / (d + 0.25) m, from d = 23.75 px on: pixels 24 to 31";
    EXPECT_LE(near.value(0, 2), 0.5F);
    settings.box = CloudBox{50, 60, 0, 1, 0, 1};
    const Cloud none = cloud_in(point_cloud(test::grey_frame(), settings));
    EXPECT_EQ(none.width, 0U);
    EXPECT_TRUE(none.data.empty());
}

TEST(RosPoints, ACubeHasOnePoint) {
    const auto count = [](double voxel_m) {
        return cloud_in(point_cloud(test::grey_frame(), {.most_points = 1000, .voxel_m = voxel_m})).width;
    };
    EXPECT_EQ(count(1e-4), 30U);
    EXPECT_EQ(count(1000), 4U) << "points lie on both sides of two planes";
    EXPECT_LT(count(0.5), 30U);
}

}  // namespace
}  // namespace disparityd::ros
