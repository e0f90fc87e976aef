// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/heartbeat.h"

namespace disparityd::mavlink {

Message heartbeat(SystemState state) {
    constexpr std::uint8_t onboard_controller = 18;  // MAV_TYPE
    constexpr std::uint8_t no_autopilot = 8;         // MAV_AUTOPILOT_INVALID
    constexpr std::uint8_t version = 3;              // of the definitions
    Message message{heartbeat_kind, {}};
    PayloadWriter(message.payload)
        .u32(0)  // custom_mode
        .u8(onboard_controller)
        .u8(no_autopilot)
        .u8(0)  // base_mode
        .u8(static_cast<std::uint8_t>(state))
        .u8(version);
    return message;
}

}  // namespace disparityd::mavlink
