// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/attitude_relay.h"

namespace disparityd::mavlink {

void AttitudeRelay::take(std::span<const std::uint8_t> bytes, Clock::time_point now) {
    reader_.take(bytes, [&](const ReceivedFrame& frame) {
        if (frame.system != system_ || frame.component != autopilot_component) {
            return;
        }
        if (const auto level = level_of(frame.payload)) {
            came_ = now;
            giver_.add(*level, now);
        }
    });
}

void AttitudeRelay::step(Clock::time_point now, const std::function<bool(const Message&)>& send) {
    giver_.give();
    if (silent(now) && now >= next_request_ && send(attitude_request(system_))) {
        next_request_ = now + silence;
    }
}

std::string AttitudeRelay::problem(Clock::time_point now) const {
    if (silent(now)) {
        return "no ATTITUDE in MAVLink 2 comes from component 1 of system " + std::to_string(system_) +
               ", it is asked for each second; check --system-id, and that the autopilot speaks MAVLink 2 on this link";
    }
    return giver_.problem();
}

}  // namespace disparityd::mavlink
