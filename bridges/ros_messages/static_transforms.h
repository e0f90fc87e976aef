// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bridges/ros_messages/frame_names.h"
#include "bridges/ros_messages/transform_message.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// Where the left camera is on the robot, in the words of the daemon's [scan].
struct Place {
    double ahead_m = 0;    ///< of the parent frame's origin
    double left_m = 0;     ///< of it
    double height_m = 0;   ///< above it
    double roll_deg = 0;   ///< positive has the right side lower
    double pitch_deg = 0;  ///< positive looks down
    double yaw_deg = 0;    ///< positive looks left

    bool operator==(const Place&) const = default;
};

/// What the tree of frames is made of.
struct TreeOfFrames {
    FrameNames names;
    std::string right = {};       ///< the right optical frame
    std::string parent = {};      ///< the robot's frame; empty: the camera's is the root
    Place place = {};             ///< in the parent's frame
    bool places_the_scan = true;  ///< the scan's frame is a part of the tree: below the camera, in the parent's plane
};

/// Returns one line when the frame of scans is right only where the daemon's [scan] has the same yaw, which it does not
/// tell; else empty.
std::string yaw_of_scans_text(const TreeOfFrames& tree);

/// Returns the transforms that do not change: from the parent to the camera and to the scan's frame, from the camera to
/// both optical frames, from the left one to the inertial sensor and to itself as it captures. What is not known is
/// left out: `baseline_m` <= 0, the sensor's pose, and `raw_turn`, how the left eye is turned to be rectified, row by
/// row.
std::vector<Transform> static_transforms(const TreeOfFrames& tree, double baseline_m,
                                         const std::optional<disparity::InertialPose>& sensor,
                                         const std::optional<std::array<double, 9>>& raw_turn = std::nullopt);

}  // namespace disparityd::ros
