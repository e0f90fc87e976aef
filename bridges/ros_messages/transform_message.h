// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace disparityd::ros {

/// Turns the axes of an optical frame (x right, y down, z ahead) into a robot's (x ahead, y left, z up): x, y, z, w.
inline constexpr std::array<double, 4> optical_to_robot{-0.5, 0.5, -0.5, 0.5};

/// Where the child's axes are in the parent's: p_parent = rotation p_child + translation.
struct Transform {
    std::string parent;
    std::string child;
    std::array<double, 3> translation{};         ///< m
    std::array<double, 4> rotation{0, 0, 0, 1};  ///< a unit quaternion: x, y, z, w

    bool operator==(const Transform&) const = default;
};

/// Returns the quaternion x, y, z, w of a rotation matrix, row by row; w is not negative.
std::array<double, 4> quaternion(const std::array<double, 9>& matrix);

/// Returns the quaternion of turning by roll about x, then by pitch about y, then by yaw about z, all axes fixed
/// (REP-103), in degrees. With x ahead, y left and z up: a positive pitch looks down, a positive roll has the right
/// side lower, a positive yaw looks left.
std::array<double, 4> quaternion_of_degrees(double roll, double pitch, double yaw);

/// Returns a tf2_msgs/msg/TFMessage.
std::string transform_message(std::int64_t realtime_ns, std::span<const Transform> transforms);

}  // namespace disparityd::ros
