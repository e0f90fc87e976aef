// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "bridges/web/foxglove/cdr_writer.h"

namespace disparityd::foxglove {

/// Returns a tf2_msgs/msg/TFMessage that turns camera_frame (z up) into left_frame (z ahead), so that a viewer shows
/// points upright.
Bytes optical_transform(std::int64_t realtime_ns);

}  // namespace disparityd::foxglove
