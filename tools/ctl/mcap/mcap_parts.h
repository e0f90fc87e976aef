// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/ros_messages/camera_info_message.h"
#include "bridges/ros_messages/contents.h"
#include "bridges/ros_messages/topics.h"

namespace disparityd::tools {

/// Whose names topics and frames of reference have in a file.
inline constexpr ros::Naming mcap_naming = ros::Naming::image_pipeline;

/// What an MCAP file may have, as the user names it.
enum class McapPart {
    raw,         ///< both eyes as they were captured, and their lenses
    rectified,   ///< both eyes as they were matched
    disparity,   ///< DisparityImage
    depth,       ///< in metres
    depth_mm,    ///< in millimetres, 16 bits
    confidence,  ///< of disparities
    points,      ///< PointCloud2
    scan,        ///< LaserScan
    imu,         ///< the inertial sensor
    sensors,     ///< what else the camera measures: temperatures, air, magnetic field
    tf           ///< /tf_static
};

using McapParts = std::set<McapPart>;

/// Returns the parts of "raw,depth". Throws std::invalid_argument with one line for a word that is none.
McapParts parse_mcap_parts(const std::string& words);

/// Whether any of them is made of frames that were matched, and so of frames that a daemon sends.
bool needs_matching(const McapParts& parts);

/// Returns the word of a part.
std::string word_of(McapPart part);

/// Returns all words with what they mean, for --help: "raw (...), rectified (...)".
std::string mcap_parts_help();

/// A topic whose messages are made of frames of the client library, or of their samples.
struct McapTopic {
    ros::Content content;
    McapPart part;
    std::string name;  ///< "/stereo/depth/image_rect"
};

/// Returns the topics of the parts below /CAMERA, with the names of docs/ros2.md, in their order; none for raw and tf.
/// `colour`: the rectified pair is in colour. Where the raw pair is there, camera_info of the eyes is that of their
/// lenses, which is not made of frames.
std::vector<McapTopic> topics_of(const McapParts& parts, const std::string& camera, bool colour);

/// Returns the topics of the raw pair as frames of a daemon carry it: of each eye the image and its camera_info.
std::vector<McapTopic> raw_topics_of(const std::string& camera);

/// Returns the topic of an eye below /CAMERA: "/stereo/left/image_raw" for the name "image_raw".
std::string topic_of_eye(const std::string& camera, ros::Camera eye, std::string_view name);

/// Throws std::invalid_argument with one line for what is no name of a camera.
void check_camera_name(const std::string& name);

}  // namespace disparityd::tools
