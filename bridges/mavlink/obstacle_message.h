// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/mavlink/mavlink_frame.h"
#include "clients/cpp/disparity_client.hpp"

/// From an obstacle scan to messages, without I/O. Unknown is never free.
namespace disparityd::mavlink {

inline constexpr MessageKind obstacle_distance_kind{330, 23, 167};
inline constexpr MessageKind obstacle_distance_3d_kind{11037, 130, 28};

/// Sectors of OBSTACLE_DISTANCE, each 5 degrees wide, all around: the middle of sector 0 is straight ahead, that of
/// sector i is 5 i degrees to the right. Autopilots take a message with this grid as it is; they resample others, or
/// read beyond the 72 values.
inline constexpr std::size_t message_sectors = 72;
inline constexpr int sector_width_deg = 5;

/// No obstacle is known, and neither that there is none.
inline constexpr std::uint16_t unknown_cm = 0xffff;

/// Between which distances obstacles are sent: 1 <= min_cm < max_cm <= 65000.
struct DistanceLimits {
    std::uint16_t min_cm = 20;   ///< nearer obstacles are sent as at this distance: autopilots ignore nearer ones
    std::uint16_t max_cm = 800;  ///< farther ones are not sent, and a sector is free when it is free up to here

    /// An obstacle counts as being as near as something can hide before it, for OBSTACLE_DISTANCE.
    bool hidden_as_obstacle = false;

    /// Returns the value of a sector without obstacle.
    std::uint16_t free_cm() const { return static_cast<std::uint16_t>(max_cm + 1); }
};

using SectorDistances = std::array<std::uint16_t, message_sectors>;

/// Returns the distances of the message in cm, rounded down. In each of its sectors the nearest obstacle wins; one that
/// is nearer than can be measured is at most at the largest distance. Without an obstacle within the limits it is free
/// only when free sectors of the scan cover all of it, else unknown.
SectorDistances sector_distances(const disparity::Scan& scan, const DistanceLimits& limits);

/// Returns OBSTACLE_DISTANCE in MAV_FRAME_BODY_FRD. `time_us` is the time of capture since this machine started.
Message obstacle_distance(const SectorDistances& distances, const DistanceLimits& limits, std::uint64_t time_us);

/// Returns one OBSTACLE_DISTANCE_3D in MAV_FRAME_BODY_FRD for each occupied sector of the scan within the limits, the
/// nearest first: x ahead, y right, z down in m from the scan's origin, in the middle of the sector. `time_ms` is the
/// time of capture since this machine started, the same for all. `camera_height_m` is the camera's height above the
/// ground: z is that of the obstacle's part nearest to the camera's height. Without it z is 0: the obstacle is level
/// with the camera. Obstacles are moved along their direction so that their distance lies within the limits, or
/// autopilots would ignore them.
std::vector<Message> obstacles_3d(const disparity::Scan& scan, const DistanceLimits& limits,
                                  std::optional<double> camera_height_m, std::uint32_t time_ms);

}  // namespace disparityd::mavlink
