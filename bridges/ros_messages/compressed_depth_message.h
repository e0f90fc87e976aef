// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// How depths are compressed, without loss in either case.
enum class DepthCodec {
    png,  ///< which every compressed_depth_image_transport reads
    rvl   ///< in half of the time; read by those since Jazzy
};

/// Returns a sensor_msgs/msg/CompressedImage as compressed_depth_image_transport has it: "16UC1; compressedDepth png"
/// or "... rvl". Values are those of depth_mm_image(): mm, 0 unknown, 65535 beyond 65.534 m. Nothing when the frame
/// does not carry the depths.
std::optional<std::string> compressed_depth(const disparity::Frame& frame, DepthCodec codec,
                                            const FrameNames& names = {});

}  // namespace disparityd::ros
