// SPDX-License-Identifier: Apache-2.0
//
// Prints what a session sends, for decode_foxglove.cjs, which knows what must be in it. A text is a line "text JSON", a
// binary message is a line "binary HEXADECIMAL".
#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "bridges/web/foxglove/session.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace {

using namespace disparityd::foxglove;
using disparity::Product;
namespace test = disparityd::test;

constexpr std::int64_t received_ns = test::stamp_ns + 40'000'000;

void print(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
        std::printf("text %s\n", text.c_str());
    }
}

void print(const std::vector<Message>& messages) {
    for (const Message& message : messages) {
        std::printf("binary ");
        for (const char byte : message.head + *message.payload) {
            std::printf("%02x", static_cast<unsigned char>(byte));
        }
        std::printf("\n");
    }
}

/// Subscribes to every channel; its id is 100 more than the channel's.
void subscribe_to_all(FoxgloveSession& session) {
    nlohmann::json list = nlohmann::json::array();
    for (const ChannelFacts& facts : all_channels()) {
        const auto id = static_cast<std::uint32_t>(facts.channel);
        list.push_back({{"id", id + 100}, {"channelId", id}});
    }
    print(session.on_text(nlohmann::json{{"op", "subscribe"}, {"subscriptions", list}}.dump()));
}

void print_frame(FoxgloveSession& session, const disparity::Frame& frame) {
    EncodedFrame encoded(frame);
    print(session.on_frame(encoded, received_ns));
}

}  // namespace

int main() {
    FoxgloveSession session({.name = "disparityd", .version = "1.2.3", .session_id = "one"},
                            {.products = {Product::disparity, Product::confidence, Product::depth, Product::left,
                                          Product::scan, Product::depth_error},
                             .calibrated = true,
                             .sensors = true});
    print(session.greeting());
    subscribe_to_all(session);
    print_frame(session, test::grey_frame());
    print(session.on_sensors(test::sensor_batch(), received_ns));
    print(session.on_status(test::daemon_status(), received_ns));
    print(session.set_offer({.products = {Product::disparity, Product::left_colour}, .calibrated = true}));
    print_frame(session, test::colour_frame());
    return std::ferror(stdout) == 0 && std::fflush(stdout) == 0 ? 0 : 1;
}
