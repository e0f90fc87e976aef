// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bridges/ros_messages/frame_names.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// Where a ray ends before whose obstacle something may hide that was not measured.
enum class HiddenSpace {
    ignored,  ///< at the obstacle that was measured: a program that clears its map along rays clears the hidden space
    obstacle  ///< where the hidden space begins: only what is known to be free is cleared
};

/// Returns a sensor_msgs/msg/LaserScan of an obstacle scan in the scan's frame, or nothing when it has no sectors. A
/// ray is the middle of a sector; rays are equally far from each other, and sectors that are not are resampled. Ranges
/// in m:
///
/// - a number: the nearest obstacle, or the space before it that `hidden` makes one; at least range_min, since
///   programs leave nearer ones out. One that is nearer than can be measured (ScanSector::is_near()) is as near as it
///   may be: where the way to it ends that is known to be free;
/// - +infinity: no obstacle up to range_max;
/// - NaN: unknown. A program that takes +infinity for free space clears its map along the ray. So a sector of which
///   only a part is known to be free is NaN, too, as are gaps between sectors: nobody looked there, and an obstacle may
///   stand there.
///
/// Intensities are confidences of the obstacle, 0 .. 255, 0 without one.
std::optional<std::string> laser_scan(const disparity::Scan& scan, std::int64_t realtime_ns,
                                      const FrameNames& names = {}, HiddenSpace hidden = HiddenSpace::ignored);

}  // namespace disparityd::ros
