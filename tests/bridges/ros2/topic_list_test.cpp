// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/topic_list.h"

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "bridges/ros_messages/encode.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros2 {
namespace {

using Words = std::vector<std::string>;

BridgeSettings settings_of(ros::Naming naming, bool tf = true) {
    BridgeSettings settings;
    settings.topics = ros::all_topics(naming, "/a", true);
    settings.quality = {.depth = 50};
    settings.encoding.names = ros::frame_names(naming, "a");
    settings.publishes_tf = tf;
    return settings;
}

std::map<std::string, Words> lines_of(const BridgeSettings& settings) {
    std::map<std::string, Words> lines;
    std::istringstream text(topic_list(settings));
    for (std::string line; std::getline(text, line);) {
        std::istringstream words(line);
        std::string topic;
        words >> topic;
        for (std::string word; words >> word;) {
            lines[topic].push_back(word);
        }
    }
    return lines;
}

TEST(Ros2TopicList, SaysHowEachIsSent) {
    const std::map<std::string, Words> lines = lines_of(settings_of(ros::Naming::image_pipeline));
    EXPECT_EQ(lines.at("/a/depth/image_rect"),
              (Words{"sensor_msgs/msg/Image", "a_left_optical_frame", "reliable", "volatile", "keep-last-10"}));
    EXPECT_EQ(lines.at("/a/imu/data_raw"),
              (Words{"sensor_msgs/msg/Imu", "a_imu_link", "reliable", "volatile", "keep-last-50"}));
    EXPECT_EQ(lines.at("/tf_static"),
              (Words{"tf2_msgs/msg/TFMessage", "-", "reliable", "transient-local", "keep-last-1"}));
    EXPECT_FALSE(lines_of(settings_of(ros::Naming::image_pipeline, false)).contains("/tf_static"));
}

/// Returns the frame in the header of a message about this, or "-".
std::string encoded_frame(ros::Content content, const ros::Encoding& encoding) {
    std::optional<std::string> message = ros::encode(content, test::sensor_batch().samples.front(), encoding.names);
    if (!message) {
        disparity::Frame frame = test::grey_frame();
        for (const disparity::Product product : {disparity::Product::right, disparity::Product::left_colour}) {
            const std::uint32_t bytes = product == disparity::Product::right ? 1 : 3;
            frame.planes.push_back(test::plane_of_bytes(product, bytes, std::vector<std::uint8_t>(32 * bytes)));
        }
        message = ros::encode(content, frame, encoding);
    }
    if (!message || content == ros::Content::clock) {
        return "-";
    }
    const std::string header = test::CdrReader(*message).header();
    return header.substr(header.find(' ') + 1);
}

TEST(Ros2TopicList, FramesAreThoseOfTheMessages) {
    for (const ros::Naming naming : {ros::Naming::image_pipeline, ros::Naming::zed}) {
        const BridgeSettings settings = settings_of(naming);
        const std::map<std::string, Words> lines = lines_of(settings);
        EXPECT_EQ(lines.size(), settings.topics.size() + 1);
        for (const ros::Topic& topic : settings.topics) {
            EXPECT_EQ(lines.at(topic.name).at(1), encoded_frame(topic.content, settings.encoding)) << topic.name;
        }
    }
}

}  // namespace
}  // namespace disparityd::ros2
