// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bridges/ros_messages/contents.h"
#include "bridges/ros_messages/frame_names.h"

namespace disparityd::ros {

/// Whose names topics and frames of reference have.
enum class Naming {
    image_pipeline,  ///< stereo_image_proc's
    zed              ///< those of the ZED's wrapper since 5.1
};

/// A topic that may be subscribed to.
struct Topic {
    Content content;
    std::string name;  ///< of ROS, from the root: "/stereo/left/image_rect"
};

/// Whether it is a name that a node, a namespace's part or a prefix of frames may have: a letter or _, then letters,
/// digits and _.
bool is_ros_name(std::string_view name);

/// Returns whether it is "" or "/", or such names with / between and maybe before them.
bool is_ros_namespace(std::string_view name);

/// Whether frames of reference may have the name: letters, digits, _, -, . and /, which tf2 refuses at the beginning.
bool is_frame_name(std::string_view name);

/// Returns the namespace that topics have by default: "/NAME", as the ZED's wrapper "/NAME/zed_node".
std::string default_namespace(Naming naming, const std::string& camera_name);

/// Returns all topics of a namespace, each name once; a content may have several. `clock`: /clock, too.
std::vector<Topic> all_topics(Naming naming, const std::string& name_space, bool clock);

/// Returns the frames of reference of a camera.
FrameNames frame_names(Naming naming, const std::string& camera_name);

/// Returns the frame of the right optical frame, which only transforms name.
std::string right_frame_name(Naming naming, const std::string& camera_name);

}  // namespace disparityd::ros
