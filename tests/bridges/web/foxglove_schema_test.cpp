// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/message_definitions.h"
#include "bridges/web/foxglove/channels.h"
#include "bridges/web/foxglove/status_schema.h"
#include "clients/json/message_json.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::foxglove {
namespace {

using ros::ros2msg;
using ros::schema_name;

TEST(FoxgloveSchema, ContainedMessagesFollowALineOf80) {
    EXPECT_EQ(ros2msg("sensor_msgs/Temperature"),
              "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n" + std::string(80, '=') +
                  "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n"
                  "string frame_id\n" +
                  std::string(80, '=') + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
}

TEST(FoxgloveSchema, AMessageIsDefinedOnce) {
    const std::string text = ros2msg("stereo_msgs/DisparityImage");
    const std::size_t first = text.find("MSG: sensor_msgs/RegionOfInterest");
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(text.find("MSG: sensor_msgs/RegionOfInterest", first + 1), std::string::npos);
}

TEST(FoxgloveSchema, EachChannelHasOne) {
    for (const ChannelFacts& facts : all_channels()) {
        if (const std::string_view message = ros::message_name(facts.channel); !message.empty()) {
            EXPECT_FALSE(ros2msg(message).empty()) << facts.topic;
        }
    }
    EXPECT_THROW(ros2msg("sensor_msgs/NavSatFix"), std::out_of_range);
}

TEST(FoxgloveSchema, NamesAreThoseOfRos2) {
    EXPECT_EQ(schema_name("stereo_msgs/DisparityImage"), "stereo_msgs/msg/DisparityImage");
}

TEST(FoxgloveSchema, TheStatusHasTheFieldsThatAreSent) {
    const auto schema = nlohmann::json::parse(status_schema());
    EXPECT_EQ(schema["type"], "object");
    const nlohmann::json sent = disparityd::json::to_json(test::daemon_status());
    for (const auto& [key, value] : sent.items()) {
        EXPECT_TRUE(schema["properties"].contains(key)) << key;
    }
    EXPECT_EQ(schema["properties"]["steps"]["items"]["properties"]["p90_us"]["type"], "number");
    EXPECT_EQ(schema["properties"]["camera"]["properties"]["model"]["type"], "string");
    EXPECT_EQ(schema["properties"]["record"]["properties"]["active"]["type"], "boolean");
    EXPECT_EQ(schema["properties"]["notices"]["items"]["type"], "string");
}

}  // namespace
}  // namespace disparityd::foxglove
