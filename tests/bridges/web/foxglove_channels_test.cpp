// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "bridges/web/foxglove/channels.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::foxglove {
namespace {

using disparity::Product;

std::set<std::string> topics(const Offer& offer) {
    std::set<std::string> list;
    for (const ChannelFacts& facts : all_channels()) {
        if (needs_of(facts.channel, offer)) {
            list.insert(std::string(facts.topic));
        }
    }
    return list;
}

std::vector<Product> products(Channel channel, const Offer& offer) {
    return needs_of(channel, offer).value().products;
}

TEST(FoxgloveChannels, AnIdNamesOneTopic) {
    std::set<Channel> ids;
    std::set<std::string_view> names;
    for (const ChannelFacts& facts : all_channels()) {
        EXPECT_TRUE(ids.insert(facts.channel).second) << facts.topic;
        EXPECT_TRUE(names.insert(facts.topic).second) << facts.topic;
    }
}

TEST(FoxgloveChannels, WithoutADaemonThereIsTheStatus) {
    EXPECT_EQ(topics({}), (std::set<std::string>{"/status"}));
}

TEST(FoxgloveChannels, WhatNeedsACalibrationIsThereWithOne) {
    const std::vector<Product> served{Product::disparity, Product::left};
    EXPECT_EQ(topics({.products = served}), (std::set<std::string>{"/disparity", "/left/image_rect",
                                                                   "/left/image_rect/compressed", "/status", "/tf"}));
    EXPECT_EQ(
        topics({.products = served, .calibrated = true}),
        (std::set<std::string>{"/depth/image_rect_raw", "/disparity", "/left/camera_info", "/left/image_rect",
                               "/left/image_rect/compressed", "/points", "/right/camera_info", "/status", "/tf"}));
}

TEST(FoxgloveChannels, EachOtherProductHasAChannel) {
    EXPECT_TRUE(topics({.products = {Product::scan}}).contains("/scan"));
    EXPECT_TRUE(topics({.products = {Product::confidence}}).contains("/confidence"));
    EXPECT_TRUE(topics({.products = {Product::depth_error}}).contains("/depth/error"));
    EXPECT_TRUE(topics({.products = {Product::depth}}).contains("/depth/image_rect_raw"));
    EXPECT_TRUE(topics({.products = {Product::left_colour}}).contains("/left/image_rect"));
    EXPECT_TRUE(topics({.sensors = true}).contains("/imu"));
}

TEST(FoxgloveChannels, DepthIsTheDaemonsWhereItServesOne) {
    const Offer both{.products = {Product::disparity, Product::depth}, .calibrated = true};
    EXPECT_EQ(products(Channel::depth, both), (std::vector{Product::depth}));
    EXPECT_EQ(products(Channel::depth, {.products = {Product::disparity}, .calibrated = true}),
              (std::vector{Product::disparity}));
}

TEST(FoxgloveChannels, PointsComeFromDisparitiesAndTakeTheColour) {
    const Offer all{.products = {Product::disparity, Product::depth, Product::left, Product::left_colour},
                    .calibrated = true};
    EXPECT_EQ(products(Channel::points, all), (std::vector{Product::disparity, Product::left_colour}));
    EXPECT_EQ(products(Channel::points, {.products = {Product::depth, Product::left}, .calibrated = true}),
              (std::vector{Product::depth, Product::left}));
}

TEST(FoxgloveChannels, WhatComesBesideThePlanesTakesTheSmallestPlane) {
    const Offer offer{.products = {Product::disparity, Product::confidence, Product::left_colour}, .calibrated = true};
    EXPECT_EQ(products(Channel::left_info, offer), (std::vector{Product::confidence}));
    EXPECT_EQ(products(Channel::transforms, {.products = {Product::disparity, Product::scan}}),
              (std::vector{Product::scan}));
}

TEST(FoxgloveChannels, WantedProductsAreThereOnce) {
    Wanted wanted{.products = {Product::depth}};
    wanted.add({.products = {Product::disparity, Product::depth}});
    wanted.add({.sensors = true});
    wanted.add({.products = {Product::left}, .status = true});
    EXPECT_EQ(
        wanted,
        (Wanted{.products = {Product::disparity, Product::depth, Product::left}, .sensors = true, .status = true}));
}

TEST(FoxgloveChannels, TheStatusTellsTheCalibration) {
    v1::Status status = test::daemon_status();
    EXPECT_TRUE(offer_of(status).calibrated);
    status.mutable_geometry()->set_baseline_mm(0);
    EXPECT_FALSE(offer_of(status).calibrated);
}

TEST(FoxgloveChannels, SensorsAreThoseOfACameraOrOfARecording) {
    v1::Status status;
    EXPECT_FALSE(offer_of(status).sensors) << "the source is being prepared";
    status.mutable_geometry()->set_width(640);
    EXPECT_TRUE(offer_of(status).sensors) << "a recording may have samples";
    status.set_synthetic(true);
    EXPECT_FALSE(offer_of(status).sensors) << "a rendered source has none";
    status.set_synthetic(false);
    status.mutable_camera();
    EXPECT_FALSE(offer_of(status).sensors) << "a live camera without sensors";
    status.mutable_sensors();
    EXPECT_TRUE(offer_of(status).sensors);
}

}  // namespace
}  // namespace disparityd::foxglove
