// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/ros_mcap.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bridges/ros_messages/message_definitions.h"

namespace disparityd::tools {

ros::Encoding encoding_for_files(const std::string& camera) {
    ros::Encoding encoding;
    encoding.names = ros::frame_names(mcap_naming, camera);
    encoding.cloud.most_points = UINT32_MAX;  // a file has room for all
    encoding.hidden = ros::HiddenSpace::obstacle;
    return encoding;
}

RosMcap::Channel& RosMcap::channel_of(const RosMessageBytes& message) {
    const auto known = channels_.find(message.topic);
    if (known != channels_.end()) {
        return known->second;
    }
    auto schema = schemas_.find(message.type);
    if (schema == schemas_.end()) {
        const std::uint16_t id =
            file_.add_schema(ros::schema_name(message.type), "ros2msg", ros::ros2msg(message.type));
        schema = schemas_.emplace(message.type, id).first;
    }
    const std::uint16_t id = file_.add_channel(schema->second, message.topic, "cdr");
    return channels_.emplace(message.topic, Channel{id, 0}).first->second;
}

void RosMcap::write(const RosMessageBytes& message) {
    Channel& channel = channel_of(message);
    const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, message.realtime_ns));  // from 1970 on
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.bytes.data());
    file_.write({channel.id, channel.next, time_ns, time_ns, {bytes, message.bytes.size()}});
    ++channel.next;
    ++given_;
}

void RosMcap::end_frame() {
    frame_ends_.push_back(given_);
    for (; !frame_ends_.empty() && frame_ends_.front() <= file_.messages(); frame_ends_.pop_front()) {
        ++whole_frames_;
    }
}

std::uint64_t RosMcap::frames() const {
    const auto behind = std::upper_bound(frame_ends_.begin(), frame_ends_.end(), file_.messages());
    return whole_frames_ + static_cast<std::uint64_t>(behind - frame_ends_.begin());
}

void RosMcap::write(const disparity::Frame& frame, const std::vector<McapTopic>& topics,
                    const ros::Encoding& encoding) {
    for (const McapTopic& topic : topics) {
        if (std::optional<std::string> bytes = ros::encode(topic.content, frame, encoding)) {
            write({topic.name, ros::message_name(topic.content), frame.realtime_ns, std::move(*bytes)});
        }
    }
}

void RosMcap::write(const disparity::SensorSample& sample, const std::vector<McapTopic>& topics,
                    const ros::FrameNames& names) {
    for (const McapTopic& topic : topics) {
        if (std::optional<std::string> bytes = ros::encode(topic.content, sample, names)) {
            write({topic.name, ros::message_name(topic.content), sample.realtime_ns, std::move(*bytes)});
        }
    }
}

void RosMcap::write(std::int64_t realtime_ns, const std::vector<ros::Transform>& static_transforms) {
    if (!static_transforms.empty()) {
        write(
            {"/tf_static", "tf2_msgs/TFMessage", realtime_ns, ros::transform_message(realtime_ns, static_transforms)});
    }
}

std::map<std::string, std::uint64_t> RosMcap::messages_of_topics() const {
    std::map<std::string, std::uint64_t> counts;
    const auto& written = file_.messages_of_channels();
    for (const auto& [topic, channel] : channels_) {
        if (const auto found = written.find(channel.id); found != written.end()) {
            counts[topic] = found->second;
        }
    }
    return counts;
}

}  // namespace disparityd::tools
