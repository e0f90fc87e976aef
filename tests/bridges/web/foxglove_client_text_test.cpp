// SPDX-License-Identifier: Apache-2.0
//
// What a client may send, and what it may not.
#include <gtest/gtest.h>

#include "bridges/web/foxglove/client_text.h"

namespace disparityd::foxglove {
namespace {

std::string refusal(std::string_view text) {
    const ClientRequest request = read_client_text(text);
    const auto* refused = std::get_if<Refusal>(&request);
    return refused == nullptr ? "" : refused->why;
}

TEST(FoxgloveClientText, Subscribe) {
    const ClientRequest request = read_client_text(
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5,"more":[]}]})");
    const auto& items = std::get<SubscribeRequest>(request).items;
    ASSERT_EQ(items.size(), 2U);
    EXPECT_EQ(items[0].id, 0U);
    EXPECT_EQ(items[0].channel, 3U);
    EXPECT_EQ(items[1].id, 4294967295U);
    EXPECT_EQ(items[1].channel, 5U);
}

TEST(FoxgloveClientText, Unsubscribe) {
    const ClientRequest request = read_client_text(R"({"subscriptionIds":[7,0],"op":"unsubscribe"})");
    EXPECT_EQ(std::get<UnsubscribeRequest>(request).ids, (std::vector<std::uint32_t>{7, 0}));
}

TEST(FoxgloveClientText, WhatIsNoRequestIsRefused) {
    for (const char* text : {"", "{", "[]", "null", "3", "\"subscribe\"", "{}", R"({"op":3})", R"({"op":null})",
                             R"({"op":["subscribe"]})", "\xff\xfe", "{\"op\":\"subscribe\xff\"}", "nan", "{'op':1}"}) {
        EXPECT_FALSE(refusal(text).empty()) << text;
    }
}

TEST(FoxgloveClientText, AnUnknownOperationIsNamed) {
    EXPECT_EQ(refusal(R"({"op":"getParameters"})"),
              "the operation \"getParameters\" is not supported: this server has no capabilities, only subscribe and "
              "unsubscribe");
    const std::string why = refusal(R"({"op":"a\nb)" + std::string(1000, 'x') + R"("})");
    EXPECT_LT(why.size(), 200U) << "a long name is cut";
    EXPECT_EQ(why.find('\n'), std::string::npos);
}

TEST(FoxgloveClientText, IdsAreWholeNumbersOf32Bits) {
    for (const char* id : {"-1", "4294967296", "1.5", "1e3", "\"1\"", "null", "{}", "99999999999999999999"}) {
        EXPECT_NE(refusal(std::string(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":)") + id +
                          R"(,"channelId":1}]})")
                      .find("subscriptions[1].id"),
                  std::string::npos)
            << id;
        EXPECT_NE(refusal(std::string(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":)") + id + "}]}")
                      .find("subscriptions[0].channelId"),
                  std::string::npos)
            << id;
        EXPECT_NE(
            refusal(std::string(R"({"op":"unsubscribe","subscriptionIds":[)") + id + "]}").find("subscriptionIds[0]"),
            std::string::npos)
            << id;
    }
}

TEST(FoxgloveClientText, ListsAreArrays) {
    for (const char* list : {"{}", "3", "null", "\"\""}) {
        EXPECT_NE(refusal(std::string(R"({"op":"subscribe","subscriptions":)") + list + "}"), "") << list;
        EXPECT_NE(refusal(std::string(R"({"op":"unsubscribe","subscriptionIds":)") + list + "}"), "") << list;
    }
    EXPECT_NE(refusal(R"({"op":"subscribe"})"), "");
    EXPECT_NE(refusal(R"({"op":"unsubscribe"})"), "");
    EXPECT_NE(refusal(R"({"op":"subscribe","subscriptions":[3,[]]})"), "");
}

TEST(FoxgloveClientText, ALongTextIsNotRead) {
    std::string text = R"({"op":"unsubscribe","subscriptionIds":[]})";
    text.append(longest_text - text.size(), ' ');
    EXPECT_EQ(refusal(text), "");
    text += ' ';
    EXPECT_EQ(refusal(text), "a text of 65537 bytes is too long: at most 65536 are read");
}

TEST(FoxgloveClientText, DeepNestingDoesNotEndTheProgram) {
    EXPECT_NE(refusal(std::string(longest_text, '[')), "");
    const std::string deep(20000, '[');
    EXPECT_EQ(refusal(R"({"op":"unsubscribe","subscriptionIds":[],"x":)" + deep + std::string(deep.size(), ']') + "}"),
              "");
}

}  // namespace
}  // namespace disparityd::foxglove
