// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

/// The definitions of messages, and what follows from them. Each function throws std::out_of_range for a message that
/// is not defined here.
namespace disparityd::ros {

/// Returns the definition of a ROS 2 message, "package/Name", with those that it contains: the schema encoding
/// "ros2msg".
std::string ros2msg(std::string_view name);

/// Returns "package/msg/Name", as ROS 2 calls the message "package/Name".
std::string schema_name(std::string_view name);

/// Returns "package::msg::dds_::Name_", as ROS 2 calls it over DDS.
std::string dds_type_name(std::string_view name);

/// Returns "RIHS01_" and 64 digits: a hash of the definition (REP-2011), by which nodes since Iron know the type; empty
/// for a message that is only a part of others.
std::string_view type_hash(std::string_view name);

}  // namespace disparityd::ros
