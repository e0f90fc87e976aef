// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bridges/web/foxglove/session.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::foxglove {
namespace {

using disparity::Product;
using nlohmann::json;

const Offer everything{.products = {Product::disparity, Product::confidence, Product::depth, Product::left,
                                    Product::scan, Product::depth_error},
                       .calibrated = true,
                       .sensors = true};

FoxgloveSession session_with(Offer offer) {
    return FoxgloveSession({.name = "disparityd", .version = "1.2.3", .session_id = "abc"}, std::move(offer));
}

std::string subscribe(std::uint32_t id, Channel channel) {
    return json{{"op", "subscribe"},
                {"subscriptions", {{{"id", id}, {"channelId", static_cast<std::uint32_t>(channel)}}}}}
        .dump();
}

std::string unsubscribe(std::uint32_t id) {
    return json{{"op", "unsubscribe"}, {"subscriptionIds", {id}}}.dump();
}

/// Returns the level and the message of the one status text.
std::pair<int, std::string> complaint(const std::vector<std::string>& texts) {
    if (texts.size() != 1) {
        ADD_FAILURE() << texts.size() << " texts";
        return {};
    }
    const json text = json::parse(texts[0]);
    EXPECT_EQ(text["op"], "status");
    return {text["level"], text["message"]};
}

TEST(FoxgloveSession, GreetsWithItsNameAndItsChannels) {
    const std::vector<std::string> texts = session_with({.products = {Product::confidence}}).greeting();
    ASSERT_EQ(texts.size(), 2U);
    EXPECT_EQ(json::parse(texts[0]), (json{{"op", "serverInfo"},
                                           {"name", "disparityd"},
                                           {"capabilities", json::array()},
                                           {"supportedEncodings", json::array()},
                                           {"metadata", {{"version", "1.2.3"}}},
                                           {"sessionId", "abc"}}));
    const json advertise = json::parse(texts[1]);
    EXPECT_EQ(advertise["op"], "advertise");
    ASSERT_EQ(advertise["channels"].size(), 3U);
    const json& channel = advertise["channels"][0];
    EXPECT_EQ(channel["id"], 8);
    EXPECT_EQ(channel["topic"], "/confidence");
    EXPECT_EQ(channel["encoding"], "cdr");
    EXPECT_EQ(channel["schemaName"], "sensor_msgs/msg/Image");
    EXPECT_EQ(channel["schemaEncoding"], "ros2msg");
    EXPECT_EQ(advertise["channels"][2]["topic"], "/status");
    EXPECT_EQ(advertise["channels"][2]["encoding"], "json");
    EXPECT_EQ(advertise["channels"][2]["schemaEncoding"], "jsonschema");
}

TEST(FoxgloveSession, SendsWhatIsSubscribedWithItsId) {
    FoxgloveSession session = session_with(everything);
    EXPECT_TRUE(session.on_text(subscribe(0x04030201, Channel::confidence)).empty());
    const disparity::Frame frame = test::grey_frame();
    EncodedFrame encoded(frame);
    const std::vector<Message> messages = session.on_frame(encoded, 0x1817161514131211);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].head, test::bytes({1, 1, 2, 3, 4, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18}));
    EXPECT_EQ(messages[0].payload, encoded.payload(Channel::confidence));
    session.on_text(unsubscribe(0x04030201));
    EXPECT_TRUE(session.on_frame(encoded, 0).empty());
}

TEST(FoxgloveSession, SessionsShareAPayload) {
    FoxgloveSession one = session_with(everything);
    FoxgloveSession other = session_with(everything);
    one.on_text(subscribe(1, Channel::depth));
    other.on_text(subscribe(2, Channel::depth));
    const disparity::Frame frame = test::grey_frame();
    EncodedFrame encoded(frame);
    EXPECT_EQ(one.on_frame(encoded, 0).at(0).payload, other.on_frame(encoded, 0).at(0).payload);
}

TEST(FoxgloveSession, WhatWasEncodedElsewhereGoesToWhatIsSubscribedNow) {
    FoxgloveSession session = session_with(everything);
    session.on_text(subscribe(1, Channel::depth));
    session.on_text(subscribe(2, Channel::scan));
    EXPECT_EQ(session.subscribed(), (std::vector{Channel::depth, Channel::scan}));
    const disparity::Frame frame = test::grey_frame();
    const Payloads payloads = EncodedFrame(frame).payloads(session.subscribed());
    EXPECT_EQ(payloads.size(), 2U);
    session.on_text(unsubscribe(1));
    session.on_text(subscribe(3, Channel::confidence));
    const std::vector<Message> messages = session.on_payloads(payloads, 0);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].head[1], 2);
}

TEST(FoxgloveSession, AFrameWithoutThePlaneGivesNoMessage) {
    FoxgloveSession session = session_with(everything);
    session.on_text(subscribe(1, Channel::scan));
    session.on_text(subscribe(2, Channel::left_info));
    const disparity::Frame frame = test::bare_frame();
    EncodedFrame encoded(frame);
    const std::vector<Message> messages = session.on_frame(encoded, 0);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].head[1], 2);
}

TEST(FoxgloveSession, AScanOfAnotherVersionGivesNoMessage) {
    FoxgloveSession session = session_with(everything);
    session.on_text(subscribe(1, Channel::scan));
    disparity::Frame frame = test::grey_frame();
    frame.planes.back().bytes[0] = 99;
    EncodedFrame encoded(frame);
    EXPECT_TRUE(session.on_frame(encoded, 0).empty());
}

TEST(FoxgloveSession, SamplesGiveOneMessageForWhatEachHas) {
    FoxgloveSession session = session_with(everything);
    session.on_text(subscribe(1, Channel::imu));
    session.on_text(subscribe(2, Channel::pressure));
    const std::vector<Message> messages = session.on_sensors(test::sensor_batch(), 0);
    ASSERT_EQ(messages.size(), 3U);  // the second sample has no pressure
    EXPECT_EQ(messages[0].head[1], 1);
    EXPECT_EQ(messages[1].head[1], 2);
    EXPECT_EQ(messages[2].head[1], 1);
}

TEST(FoxgloveSession, OfManySamplesTheNewestAreSent) {
    FoxgloveSession session = session_with(everything);
    session.on_text(subscribe(1, Channel::imu));
    disparity::SensorBatch batch;
    for (int i = 0; i < 2048; ++i) {
        disparity::SensorSample sample;
        sample.realtime_ns = i * 1'000'000'000LL;
        sample.inertial.emplace();
        batch.samples.push_back(sample);
    }
    const std::vector<Message> messages = session.on_sensors(batch, 0);
    ASSERT_EQ(messages.size(), most_sensor_messages);
    EXPECT_EQ(test::CdrReader(*messages.front().payload).header(), "1848.0 camera_imu");
    EXPECT_EQ(test::CdrReader(*messages.back().payload).header(), "2047.0 camera_imu");
}

TEST(FoxgloveSession, TheStatusIsJson) {
    FoxgloveSession session = session_with({});
    EXPECT_TRUE(session.on_status(test::daemon_status(), 0).empty());
    session.on_text(subscribe(1, Channel::status));
    const std::vector<Message> messages = session.on_status(test::daemon_status(), 0);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(json::parse(*messages[0].payload)["published"], 4321);
}

TEST(FoxgloveSession, WantsWhatItsSubscriptionsNeed) {
    FoxgloveSession session = session_with(everything);
    EXPECT_EQ(session.wanted(), Wanted{});
    session.on_text(subscribe(1, Channel::points));
    EXPECT_EQ(session.wanted(), (Wanted{.products = {Product::disparity, Product::left}}));
    session.on_text(subscribe(2, Channel::imu));
    session.on_text(subscribe(3, Channel::status));
    session.on_text(unsubscribe(1));
    EXPECT_EQ(session.wanted(), (Wanted{.sensors = true, .status = true}));
}

TEST(FoxgloveSession, RefusesASubscriptionThatCannotBe) {
    FoxgloveSession session = session_with({.products = {Product::left}});
    session.on_text(subscribe(1, Channel::left_image));
    EXPECT_EQ(
        complaint(session.on_text(subscribe(1, Channel::left_jpeg))),
        std::pair(2, std::string("subscribe: channel 2: the id 1 is in use; unsubscribe it or take another one")));
    EXPECT_EQ(
        complaint(session.on_text(subscribe(2, Channel::left_image))),
        std::pair(2, std::string("subscribe: channel 1 is subscribed with id 1; a channel has one subscription")));
    const std::string gone = " does not exist (now); take one of those that are advertised";
    EXPECT_EQ(complaint(session.on_text(subscribe(3, Channel::scan))), std::pair(2, "subscribe: channel 10" + gone));
    EXPECT_EQ(complaint(session.on_text(subscribe(3, static_cast<Channel>(99)))),
              std::pair(2, "subscribe: channel 99" + gone));
    EXPECT_EQ(complaint(session.on_text(unsubscribe(7))),
              std::pair(1, std::string("unsubscribe: there is no subscription with id 7")));
    EXPECT_EQ(session.wanted(), (Wanted{.products = {Product::left}})) << "the first one holds";
}

TEST(FoxgloveSession, TheRightOnesOfAListAreSubscribed) {
    FoxgloveSession session = session_with(everything);
    json list = json::array({{{"id", 1}, {"channelId", 5}}});
    for (int i = 0; i < 1000; ++i) {
        list.push_back({{"id", i}, {"channelId", 99}});
    }
    const auto [level, text] =
        complaint(session.on_text(json{{"op", "subscribe"}, {"subscriptions", list}}.dump()));  // one text for all
    EXPECT_NE(text.find("channel 99"), std::string::npos);
    EXPECT_NE(text.find("; 999 more were refused"), std::string::npos);
    EXPECT_EQ(session.wanted(), (Wanted{.products = {Product::disparity}}));
}

TEST(FoxgloveSession, AnswersHostileTexts) {
    FoxgloveSession session = session_with(everything);
    for (const std::string& text : {std::string("{"), std::string("\xff\x00{\"", 4), std::string(100, '['),
                                    std::string(R"({"op":"\ud800"})"), std::string("{\"op\":\"\xc3\"}")}) {
        EXPECT_EQ(complaint(session.on_text(text)).first, 2) << text;
    }
    EXPECT_EQ(complaint(session.on_binary()).first, 2);
    EXPECT_EQ(session.wanted(), Wanted{});
}

TEST(FoxgloveSession, TellsWhenChannelsComeAndGo) {
    FoxgloveSession session = session_with({.products = {Product::left, Product::scan}});
    session.on_text(subscribe(1, Channel::scan));
    session.on_text(subscribe(2, Channel::left_image));
    EXPECT_TRUE(session.set_offer({.products = {Product::left, Product::scan}}).empty());
    const std::vector<std::string> texts = session.set_offer({.products = {Product::left, Product::confidence}});
    ASSERT_EQ(texts.size(), 2U);
    EXPECT_EQ(json::parse(texts[0]), (json{{"op", "unadvertise"}, {"channelIds", {10}}}));
    const json advertise = json::parse(texts[1]);
    ASSERT_EQ(advertise["channels"].size(), 1U);
    EXPECT_EQ(advertise["channels"][0]["topic"], "/confidence");
    EXPECT_EQ(session.wanted(), (Wanted{.products = {Product::left}})) << "the scan's subscription has ended";
    EXPECT_TRUE(session.on_text(subscribe(1, Channel::confidence)).empty()) << "its id may be taken again";
}

TEST(FoxgloveSession, TakesTheColourWhenItIsOffered) {
    FoxgloveSession session = session_with({.products = {Product::left}});
    session.on_text(subscribe(1, Channel::left_image));
    EXPECT_TRUE(session.set_offer({.products = {Product::left, Product::left_colour}}).empty());
    EXPECT_EQ(session.wanted(), (Wanted{.products = {Product::left_colour}}));
}

}  // namespace
}  // namespace disparityd::foxglove
