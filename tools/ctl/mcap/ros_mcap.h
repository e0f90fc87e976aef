// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/transform_message.h"
#include "clients/cpp/disparity_client.hpp"
#include "formats/mcap_file.h"
#include "tools/ctl/mcap/mcap_parts.h"

namespace disparityd::tools {

/// A message of ROS 2 that is to be written.
struct RosMessageBytes {
    std::string topic;
    std::string_view type;  ///< "sensor_msgs/Image"
    std::int64_t realtime_ns = 0;
    std::string bytes;  ///< CDR
};

/// Returns how messages of a camera are made for a file.
ros::Encoding encoding_for_files(const std::string& camera);

/// Writes messages of ROS 2 into an MCAP file. A topic is there from its first message on. The time of a message in the
/// file is its stamp. One thread uses an object at a time. Throws as formats::McapFile.
class RosMcap {
public:
    RosMcap(const std::string& path, formats::McapFile::Existing existing) : file_(path, existing) {}

    void write(const RosMessageBytes& message);

    /// Write what of a frame, or of a sample, the topics have.
    void write(const disparity::Frame& frame, const std::vector<McapTopic>& topics, const ros::Encoding& encoding);
    void write(const disparity::SensorSample& sample, const std::vector<McapTopic>& topics,
               const ros::FrameNames& names);

    /// Writes /tf_static; nothing where there are none.
    void write(std::int64_t realtime_ns, const std::vector<ros::Transform>& static_transforms);

    /// Counts what was written since the last call as a frame.
    void end_frame();

    void finish() { file_.finish(); }

    // What the file has, also after one of the above has thrown: what is not in it does not count.
    std::uint64_t frames() const;
    std::uint64_t messages() const { return file_.messages(); }
    std::uint64_t bytes() const { return file_.bytes(); }
    std::map<std::string, std::uint64_t> messages_of_topics() const;

private:
    struct Channel {
        std::uint16_t id = 0;
        std::uint32_t next = 0;  ///< sequence number
    };

    Channel& channel_of(const RosMessageBytes& message);

    formats::McapFile file_;
    std::map<std::string_view, std::uint16_t>
        schemas_;  ///< by the name of the type, which lives as long as the program
    std::map<std::string, Channel, std::less<>> channels_;
    std::uint64_t given_ = 0;               ///< messages, to the file
    std::uint64_t whole_frames_ = 0;        ///< those that were in the file when the last one ended
    std::deque<std::uint64_t> frame_ends_;  ///< of the frames behind them: given_ at the end of each
};

}  // namespace disparityd::tools
