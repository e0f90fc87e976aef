// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "bridges/mavlink/mavlink_frame.h"
#include "clients/cpp/disparity_client.hpp"

/// What the autopilot says of the vehicle's attitude, without I/O.
namespace disparityd::mavlink {

inline constexpr MessageKind attitude_kind{30, 39, 28};
inline constexpr MessageKind command_long_kind{76, 152, 33};

/// How often the autopilot is asked to tell it.
inline constexpr std::uint32_t attitude_interval_us = 20000;

/// The autopilot of a vehicle, as a component: MAV_COMP_ID_AUTOPILOT1.
inline constexpr std::uint8_t autopilot_component = 1;

/// Returns where up is along the vehicle's axes, from the payload of an ATTITUDE: roll and pitch of the body's axes
/// ahead, right and down against north, east and down. Nothing when these are no numbers. Its age is 0.
std::optional<disparity::Level> level_of(std::span<const std::uint8_t> attitude);

/// Returns the COMMAND_LONG that asks the autopilot of a system for ATTITUDE in that interval.
Message attitude_request(std::uint8_t system);

}  // namespace disparityd::mavlink
