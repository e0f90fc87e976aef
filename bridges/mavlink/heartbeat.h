// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "bridges/mavlink/mavlink_frame.h"

namespace disparityd::mavlink {

inline constexpr MessageKind heartbeat_kind{0, 50, 9};

/// What the HEARTBEAT says of this component: values of MAV_STATE.
enum class SystemState : std::uint8_t {
    boot = 1,      ///< no scan was sent yet
    active = 4,    ///< scans are sent
    critical = 5,  ///< scans were sent and no longer are: no daemon, no scan, or too old ones
};

/// Returns a HEARTBEAT of an onboard computer that is no autopilot.
Message heartbeat(SystemState state);

}  // namespace disparityd::mavlink
