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

/// Returns lenses of which only that they are known counts.
v1::RawCameras raw_cameras() {
    v1::RawCameras cameras;
    for (v1::RawCamera* eye : {cameras.mutable_left(), cameras.mutable_right()}) {
        eye->mutable_rotation()->Resize(9, 0);
    }
    return cameras;
}

/// Returns the frame in the header of a message about this, or "-".
std::string encoded_frame(ros::Content content, const ros::Encoding& encoding) {
    std::optional<std::string> message = ros::encode(content, test::sensor_batch().samples.front(), encoding.names);
    if (!message) {
        disparity::Frame frame = test::grey_frame();
        using disparity::Product;
        for (const Product product : {Product::right, Product::left_colour, Product::raw_left, Product::raw_right}) {
            const std::uint32_t bytes = product == Product::left_colour ? 3 : 1;
            frame.planes.push_back(test::plane_of_bytes(product, bytes, std::vector<std::uint8_t>(32 * bytes)));
        }
        ros::Encoding known = encoding;
        known.raw =
            std::make_shared<const ros::RawCalibration>(ros::RawCalibration{frame.calibration_id, raw_cameras()});
        message = ros::encode(content, frame, known);
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
