// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "bridges/mavlink/attitude.h"

namespace disparityd::test {

/// Returns an ATTITUDE as an autopilot sends it; angles in rad.
inline std::vector<std::uint8_t> attitude_frame(std::uint8_t system, std::uint8_t component, float roll, float pitch) {
    mavlink::Message message{mavlink::attitude_kind, {}};
    mavlink::PayloadWriter(message.payload).u32(1234).f32(roll).f32(pitch).f32(1).f32(0).f32(0).f32(0);
    return mavlink::FrameWriter(system, component).frame(message);
}

}  // namespace disparityd::test
