// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bridges/ros2/bridge.h"

namespace disparityd::ros2 {

/// Returns a line for each topic that is published with these settings: its name, the message's type, the frame of
/// reference in its header ("-": it has none of one place), reliability, durability and how many messages are kept,
/// with blanks between.
std::string topic_list(const BridgeSettings& settings);

}  // namespace disparityd::ros2
