// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bridges/ros_messages/compressed_depth_message.h"
#include "bridges/ros_messages/contents.h"
#include "bridges/ros_messages/frame_names.h"
#include "bridges/ros_messages/laser_scan_message.h"
#include "bridges/ros_messages/point_cloud_message.h"
#include "bridges/ros_messages/raw_messages.h"
#include "clients/cpp/disparity_client.hpp"

/// What the daemon's clients get, as the bytes of ROS 2 messages: CDR with its header of 4 bytes, as DDS, bags of ROS 2
/// and Foxglove's protocol carry them.
namespace disparityd::ros {

/// How messages are made.
struct Encoding {
    CloudSettings cloud = {};
    int jpeg_quality = 85;  ///< 1 .. 100
    DepthCodec depth_codec = DepthCodec::png;
    FrameNames names = {};
    HiddenSpace hidden = HiddenSpace::ignored;       ///< of scans
    std::shared_ptr<const RawCalibration> raw = {};  ///< of the lenses; null: nothing is known
};

/// Returns the message about a frame, or nothing when the frame does not carry what it needs, and for contents that do
/// not come with frames. Throws nothing but for want of memory.
std::optional<std::string> encode(Content content, const disparity::Frame& frame, const Encoding& encoding);

/// Returns the message about a sample of the camera's sensors, or nothing when it has no such value.
std::optional<std::string> encode(Content content, const disparity::SensorSample& sample, const FrameNames& names);

/// Returns the name of the message, "package/Name" of ROS 2; empty for the status, which is none of ROS.
std::string_view message_name(Content content);

}  // namespace disparityd::ros
