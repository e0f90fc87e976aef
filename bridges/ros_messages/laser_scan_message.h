// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// Returns a sensor_msgs/msg/LaserScan of an obstacle scan in the scan's frame, or nothing when it has no sectors. A
/// ray is the middle of a sector; rays are equally far from each other, and sectors that are not are resampled. Ranges
/// in m:
///
/// - a number: the nearest obstacle;
/// - +infinity: no obstacle up to range_max;
/// - NaN: unknown. A program that takes +infinity for free space clears its map along the ray. So a sector of which
/// only
///   a part is known to be free is NaN, too, as are gaps between sectors: nobody looked there, and an obstacle may
///   stand there.
///
/// Intensities are confidences of the obstacle, 0 .. 255, 0 without one.
std::optional<std::string> laser_scan(const disparity::Scan& scan, std::int64_t realtime_ns,
                                      const FrameNames& names = {});

}  // namespace disparityd::ros
