// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::foxglove {

/// Returns the definition of a ROS 2 message, "package/Name", with those that it contains: the schema encoding
/// "ros2msg". Throws std::out_of_range for a message that is not defined here.
std::string ros2msg(std::string_view name);

/// Returns "package/msg/Name", as ROS 2 calls the message "package/Name".
std::string schema_name(std::string_view name);

/// Returns the JSON schema of the daemon's status, as the channel /status sends it.
std::string status_schema();

}  // namespace disparityd::foxglove
