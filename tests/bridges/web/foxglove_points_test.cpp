// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "bridges/web/foxglove/point_cloud_message.h"
#include "tests/bridges/web/cdr_reader.h"
#include "tests/bridges/web/foxglove_frames.h"

namespace disparityd::foxglove {
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
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "not dense";
    EXPECT_EQ(cdr.left(), 0U);
    return cloud;
}

constexpr std::uint32_t all = 1000;

TEST(FoxglovePoints, APointLiesWhereItsPixelShowsIt) {
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

TEST(FoxglovePoints, WhatHasNoPlaceIsNan) {
    const Cloud cloud = cloud_in(point_cloud(test::grey_frame(), all));
    for (const std::size_t pixel : {0U, 1U}) {  // rejected, too far
        for (const std::size_t field : {0U, 1U, 2U}) {
            EXPECT_TRUE(std::isnan(cloud.value(pixel, field))) << pixel;
        }
    }
}

TEST(FoxglovePoints, AColourIsPackedIntoAFloat) {
    const Cloud cloud = cloud_in(point_cloud(test::colour_frame(), all));
    EXPECT_EQ(cloud.fields.back(), "rgb");
    std::uint32_t packed = 0;
    std::memcpy(&packed, &cloud.data.at(16 * 5 + 12), sizeof packed);
    EXPECT_EQ(packed, 250U << 16 | 10U << 8 | 5U);
}

TEST(FoxglovePoints, WithoutDisparitiesTheyComeFromDepths) {
    Frame frame = test::grey_frame();
    std::erase_if(frame.planes, [](const auto& plane) {
        return plane.product == Product::disparity || plane.product == Product::left;
    });
    const Cloud cloud = cloud_in(point_cloud(frame, all));
    EXPECT_EQ(cloud.fields, (std::vector<std::string>{"x", "y", "z"}));
    EXPECT_EQ(cloud.value(19, 2), 1.019F);
}

TEST(FoxglovePoints, ARegionKeepsItsPlace) {
    Frame frame = test::grey_frame();
    const float x = cloud_in(point_cloud(frame, all)).value(19, 0);
    frame.region_x = 50;
    const Cloud cloud = cloud_in(point_cloud(frame, all));
    EXPECT_FLOAT_EQ(cloud.value(19, 0), x + 50 * cloud.value(19, 2) / 100);
}

TEST(FoxglovePoints, ALargeCloudIsThinned) {
    const Cloud whole = cloud_in(point_cloud(test::grey_frame(), 32));
    EXPECT_EQ(whole.width * whole.height, 32U);
    const Cloud thinned = cloud_in(point_cloud(test::grey_frame(), 31));  // 8 x 4 by 2
    EXPECT_EQ(thinned.width, 4U);
    EXPECT_EQ(thinned.height, 2U);
    for (const std::size_t field : {0U, 1U, 2U, 3U}) {
        EXPECT_EQ(thinned.value(5, field), whole.value(27, field)) << "the nearest of pixels 18, 19, 26, 27";
        EXPECT_EQ(thinned.value(0, field), whole.value(9, field)) << "0 is rejected, 1 too far, 9 nearer than 8";
    }
    const Cloud odd = cloud_in(point_cloud(test::grey_frame(), 7));  // by 3: 3 columns, 2 rows
    EXPECT_EQ(odd.width, 3U);
    EXPECT_EQ(odd.height, 2U);
    EXPECT_EQ(odd.value(5, 3), 217) << "of columns 6 and 7, row 3, pixel 31 is nearest";
    EXPECT_EQ(cloud_in(point_cloud(test::grey_frame(), 0)).data.size(), 16U);
}

TEST(FoxglovePoints, ThereAreNoneWithoutACalibration) {
    Frame frame = test::grey_frame();
    frame.f = 0;
    EXPECT_FALSE(point_cloud(frame, all));
    EXPECT_FALSE(point_cloud(test::bare_frame(), all));
}

}  // namespace
}  // namespace disparityd::foxglove
