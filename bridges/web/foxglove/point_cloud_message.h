// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::foxglove {

/// Returns a sensor_msgs/msg/PointCloud2 in the left camera's frame, organised: rows and columns are those of the
/// image. x, y, z are m; all are NaN where the depth is unknown or too far. "rgb" is the colour (0x00RRGGBB in the bits
/// of a float, as RViz has it), or "intensity" the grey value, 0 .. 255, as the frame carries one or the other. Depths
/// come from the disparities where the frame carries them: near the camera they are finer than a millimetre.
///
/// Only each n-th column and row is taken, with the least n that gives at most `most_points` (at least 1). Returns
/// nothing when the frame has no calibration or neither disparities nor depths.
std::optional<std::string> point_cloud(const disparity::Frame& frame, std::uint32_t most_points);

}  // namespace disparityd::foxglove
