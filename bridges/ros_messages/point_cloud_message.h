// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// A box in the robot's directions, seen from the left camera.
struct CloudBox {
    double ahead_from = 0;  ///< m
    double ahead_to = 0;    ///< m
    double left_from = 0;   ///< m; to the right is negative
    double left_to = 0;     ///< m
    double up_from = 0;     ///< m; below the camera is negative
    double up_to = 0;       ///< m
};

/// What a cloud has of a frame.
struct CloudSettings {
    std::uint32_t most_points = 640 * 480;  ///< larger images are thinned
    bool packed = false;                    ///< points without a place are left out
    double voxel_m = 0;                     ///< at most one point for each cube of this side, which packs, too; 0: all
    std::optional<CloudBox> box = {};       ///< only points in it, which packs, too

    bool is_packed() const { return packed || voxel_m > 0 || box; }
};

/// Returns a sensor_msgs/msg/PointCloud2 in the left camera's frame. x, y, z are m. "rgb" is the colour (0x00RRGGBB in
/// the bits of a float, as RViz has it), or "intensity" the grey value, 0 .. 255, as the frame carries one or the
/// other. Depths come from the disparities where the frame carries them: near the camera they are finer than a
/// millimetre.
///
/// The nearest pixel of each n x n pixels is taken, with the least n that gives at most `most_points` (at least 1).
/// Organised, rows and columns are those of the image, and x, y, z are NaN where the depth is unknown or too far;
/// packed, the cloud has one row of points with a place. Returns nothing when the frame has no calibration or neither
/// disparities nor depths.
std::optional<std::string> point_cloud(const disparity::Frame& frame, const CloudSettings& settings,
                                       const FrameNames& names = {});

}  // namespace disparityd::ros
