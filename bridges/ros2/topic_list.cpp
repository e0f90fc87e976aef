// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/topic_list.h"

#include "bridges/ros_messages/message_definitions.h"

namespace disparityd::ros2 {
namespace {

using ros::Content;

std::string frame_of(Content content, const ros::FrameNames& names) {
    switch (content) {
        case Content::scan: return names.scan;
        case Content::raw_left_image:
        case Content::raw_right_image:
        case Content::raw_left_info:
        case Content::raw_right_info: return names.raw;
        case Content::imu:
        case Content::magnetic_field:
        case Content::imu_temperature: return names.imu;
        case Content::camera_temperature:
        case Content::left_temperature:
        case Content::right_temperature:
        case Content::pressure:
        case Content::humidity: return names.camera;
        case Content::transforms:
        case Content::status:
        case Content::diagnostics:
        case Content::clock: return "-";
        default: return names.left;
    }
}

std::string line_of(const std::string& topic, std::string_view message, const std::string& frame,
                    const Quality& quality) {
    return topic + " " + ros::schema_name(message) + " " + frame + (quality.reliable ? " reliable" : " best-effort") +
           (quality.transient_local ? " transient-local" : " volatile") + " keep-last-" +
           std::to_string(quality.depth) + "\n";
}

}  // namespace

std::string topic_list(const BridgeSettings& settings) {
    std::string lines;
    for (const ros::Topic& topic : settings.topics) {
        lines += line_of(topic.name, ros::message_name(topic.content), frame_of(topic.content, settings.encoding.names),
                         quality_for(topic.content, settings.quality));
    }
    if (settings.publishes_tf) {
        lines += line_of("/tf_static", "tf2_msgs/TFMessage", "-", static_transforms_quality);
    }
    return lines;
}

}  // namespace disparityd::ros2
