// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/message_definitions.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Product;

constexpr std::uint32_t last = 31;

TEST(RosContents, EachContentHasADefinitionAHashAndAName) {
    for (std::uint32_t number = 1; number <= last; ++number) {
        const auto content = static_cast<Content>(number);
        if (content == Content::status) {
            EXPECT_EQ(message_name(content), "");
            continue;
        }
        const std::string_view name = message_name(content);
        EXPECT_FALSE(ros2msg(name).empty());
        EXPECT_EQ(type_hash(name).size(), std::string_view("RIHS01_").size() + 64) << name;
    }
    EXPECT_EQ(dds_type_name("sensor_msgs/Image"), "sensor_msgs::msg::dds_::Image_");
}

TEST(RosContents, TheRightEyeNeedsItsProducts) {
    const Offer offer{.products = {Product::left, Product::left_colour, Product::right}};
    EXPECT_EQ(needs_of(Content::right_image, offer)->products, (std::vector{Product::right}));
    EXPECT_EQ(needs_of(Content::left_grey_image, offer)->products, (std::vector{Product::left}));
    EXPECT_FALSE(needs_of(Content::right_image, {.products = {Product::left}}));
    EXPECT_EQ(products_for(Content::right_image).front(), Product::right_colour);
    EXPECT_TRUE(products_for(Content::imu).empty());
}

TEST(RosContents, AFrameHasMessagesOfWhatItCarries) {
    const disparity::Frame frame = test::grey_frame();
    for (std::uint32_t number = 1; number <= last; ++number) {
        const auto content = static_cast<Content>(number);
        const bool of_frame = !products_for(content).empty();
        const bool right = content == Content::right_image || content == Content::right_grey_image;
        const bool raw = content >= Content::raw_left_image;
        EXPECT_EQ(encode(content, frame, {}).has_value(), of_frame && !right && !raw) << number;
    }
}

TEST(RosContents, TheClockIsTheFramesTime) {
    EXPECT_EQ(encode(Content::clock, test::grey_frame(), {}),
              std::string("\0\1\0\0\0\xf1\x53\x65\x15\xcd\x5b\x07", 12));
}

}  // namespace
}  // namespace disparityd::ros
