// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/live_message.h"

#include <cstring>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace disparityd::web {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string error_of(std::string_view text) {
    const LiveRequest request = parse_live_request(text);
    const auto* const wrong = std::get_if<WrongMessage>(&request);
    return wrong == nullptr ? "" : wrong->error;
}

TEST(LiveRequestTest, ASubscriptionSaysWhatAPageWants) {
    const LiveRequest request = parse_live_request(
        R"({"type":"subscribe","images":["left","depth"],"encoding":"lossless","max_width":320,"max_rate":7.5,)"
        R"("range_m":[0.5,10],"cloud_step":4,"scan":true,"sensors":true})");
    const auto* const wanted = std::get_if<LiveSubscription>(&request);
    ASSERT_NE(wanted, nullptr);
    EXPECT_THAT(wanted->images, ElementsAre(Image::left, Image::depth));
    EXPECT_EQ(wanted->encoding, Encoding::deflate);
    EXPECT_EQ(wanted->max_width, 320);
    EXPECT_EQ(wanted->max_rate, 7.5);
    EXPECT_EQ(wanted->range, (RangeM{0.5, 10}));
    EXPECT_EQ(wanted->cloud_step, 4);
    EXPECT_TRUE(wanted->scan && wanted->sensors && wanted->wants_frames());
}

TEST(LiveRequestTest, WhatASubscriptionLeavesOutIsUsual) {
    const LiveRequest request = parse_live_request(R"({"type":"subscribe","range_m":null})");
    const auto* const wanted = std::get_if<LiveSubscription>(&request);
    ASSERT_NE(wanted, nullptr);
    EXPECT_FALSE(wanted->wants_frames() || wanted->sensors || wanted->range);
    EXPECT_EQ(wanted->encoding, Encoding::jpeg);
}

TEST(LiveRequestTest, SeenAndPoint) {
    const LiveRequest seen = parse_live_request(R"({"type":"seen","publish_index":18446744073709551615})");
    EXPECT_EQ(std::get<Seen>(seen).publish_index, 18446744073709551615U);
    const LiveRequest point = parse_live_request(R"({"type":"point","x":3,"y":4})");
    EXPECT_EQ(std::get<Point>(point).pixel, (std::pair<std::uint32_t, std::uint32_t>{3, 4}));
    EXPECT_FALSE(std::get<Point>(parse_live_request(R"({"type":"point"})")).pixel);
}

TEST(LiveRequestTest, WhateverComesIsAnswered) {
    for (const char* text :
         {"", "{", "[]", "null", "7", "{}", R"({"type":7})", R"({"type":"x"})", "\xff\xfe", "{\"type\":"}) {
        EXPECT_NE(error_of(text), "") << text;
    }
    EXPECT_THAT(error_of(R"({"type":"subscribe","images":["left","left"]})"), HasSubstr("images: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","images":["x"]})"), HasSubstr("images: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","images":7})"), HasSubstr("images: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","encoding":"png"})"), HasSubstr("encoding: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","max_width":-1})"), HasSubstr("max_width: allowed: 0.0 to 16384"));
    EXPECT_THAT(error_of(R"({"type":"subscribe","max_rate":1e99})"), HasSubstr("max_rate: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","max_rate":1e-300})"), HasSubstr("max_rate: allowed: 0 for all"));
    EXPECT_THAT(error_of(R"({"type":"subscribe","max_rate":"1"})"), HasSubstr("max_rate: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","cloud_step":65})"), HasSubstr("cloud_step: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"subscribe","scan":1})"), HasSubstr("scan: allowed: "));
    for (const char* range : {"[1]", "[2,1]", "[0,1]", "[-1,1]", "[1,1e9]", "[1,\"2\"]", "{}", "7"}) {
        EXPECT_THAT(error_of(std::string(R"({"type":"subscribe","range_m":)") + range + "}"),
                    HasSubstr("range_m: allowed: "))
            << range;
    }
    EXPECT_THAT(error_of(R"({"type":"seen","publish_index":-1})"), HasSubstr("publish_index: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"point","x":3})"), HasSubstr("point: allowed: "));
    EXPECT_THAT(error_of(R"({"type":"point","x":3,"y":-4})"), HasSubstr("y: allowed: "));
}

TEST(LiveRequestTest, DeepNestingIsNoTrouble) {
    EXPECT_NE(error_of(std::string(60000, '[')), "");
    const std::string deep = std::string(30000, '[') + std::string(30000, ']');
    EXPECT_NE(error_of(deep), "");
    EXPECT_NE(error_of(R"({"type":"subscribe","images":)" + deep + "}"), "");
    EXPECT_NE(error_of(R"({"type":"subscribe","range_m":)" + deep + "}"), "");
}

/// A frame of 4 x 2 px: disparities 8 px, but one rejected.
LiveFrame small_frame() {
    LiveFrame live;
    disparity::Frame& frame = live.frame;
    frame.publish_index = 7;
    frame.width = 4;
    frame.height = 2;
    frame.f = 100;
    frame.baseline_mm = 120;
    frame.disparities = 16;
    frame.invalid = -16;
    frame.flags =
        disparity::synthetic | disparity::interpolated | disparity::exposure_centre | disparity::blurred | 90U << 24U;
    const std::vector<std::int16_t> d16{128, 128, 128, 128, 128, -16, 128, 128};
    disparity::PlaneData plane{disparity::Product::disparity, 4, 2, 2, std::vector<std::uint8_t>(16)};
    std::memcpy(plane.bytes.data(), d16.data(), 16);
    frame.planes.push_back(plane);
    frame.planes.push_back({disparity::Product::confidence, 4, 2, 1, {9, 9, 9, 9, 9, 0, 9, 9}});
    return live;
}

json header_of(const std::vector<Bytes>& parts) {
    const std::string& head = *parts.front();
    std::uint32_t size = 0;
    std::memcpy(&size, head.data(), sizeof size);
    EXPECT_EQ(head.size(), size + sizeof size);
    return json::parse(head.substr(sizeof size));
}

TEST(FrameMessageTest, TheHeaderSaysWhereEachPartLies) {
    const LiveFrame live = small_frame();
    LiveContents contents;
    EncodedImage image;
    image.image = Image::disparity;
    image.bytes = std::make_shared<const std::string>("12345");
    contents.images = {std::make_shared<const EncodedImage>(image), std::make_shared<const EncodedImage>(image)};
    contents.cloud = depth_grid(live, 2);
    contents.skipped = 3;
    contents.scale = 2;
    const std::vector<Bytes> parts = frame_message(live, contents);
    ASSERT_EQ(parts.size(), 4U);
    const json header = header_of(parts);
    EXPECT_EQ(header["publish_index"], 7);
    EXPECT_EQ(header["skipped"], 3);
    EXPECT_EQ(header["scale"], 2);
    EXPECT_EQ(header["flags"], json::parse(R"(["interpolated","synthetic","exposure_centre","blurred"])"));
    EXPECT_EQ(header["trust"], 90);
    EXPECT_EQ(header["images"][1]["offset"], 5);
    EXPECT_EQ(header["images"][1]["bytes"], 5);
    EXPECT_EQ(header["cloud"]["offset"], 10);
    EXPECT_EQ(header["cloud"]["bytes"], parts[3]->size());
    EXPECT_EQ(header["cloud"]["width"], 2);
    EXPECT_EQ(header["cloud"]["height"], 1);
    EXPECT_FALSE(header.contains("point") || header.contains("scan"));
}

TEST(FrameMessageTest, APointHasTheFramesValues) {
    const LiveFrame live = small_frame();
    LiveContents contents;
    contents.point.pixel = {0, 0};
    const json point = header_of(frame_message(live, contents))["point"];
    EXPECT_EQ(point["disparity_px"], 8);
    EXPECT_EQ(point["depth_m"], 1.5);  // 100 px * 0.12 m / 8 px
    EXPECT_EQ(point["confidence"], 9);
    EXPECT_EQ(point["depth_error_m"], nullptr);
    contents.point.pixel = {1, 1};
    const json rejected = header_of(frame_message(live, contents))["point"];
    EXPECT_EQ(rejected["disparity_px"], nullptr);
    EXPECT_EQ(rejected["depth_m"], nullptr);
    EXPECT_EQ(rejected["confidence"], 0);
    for (const auto& outside : {std::pair{4U, 0U}, std::pair{0U, 2U}, std::pair{16384U, 16384U}}) {
        contents.point.pixel = outside;
        EXPECT_EQ(header_of(frame_message(live, contents))["point"]["confidence"], nullptr);
    }
}

}  // namespace
}  // namespace disparityd::web
