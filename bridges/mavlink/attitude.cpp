// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/attitude.h"

#include <bit>
#include <cmath>

#include "base/little_endian.h"

namespace disparityd::mavlink {
namespace {

double real(std::span<const std::uint8_t> bytes, std::size_t offset) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(base::get_little_endian(&bytes[offset], sizeof(float))));
}

}  // namespace

std::optional<disparity::Level> level_of(std::span<const std::uint8_t> attitude) {
    const double roll = real(attitude, 4);   // rad, positive: the right side is lower
    const double pitch = real(attitude, 8);  // rad, positive: the nose is higher
    if (!std::isfinite(roll) || !std::isfinite(pitch)) {
        return std::nullopt;
    }
    return disparity::Level{std::sin(pitch), std::sin(roll) * std::cos(pitch), std::cos(roll) * std::cos(pitch), {}};
}

Message attitude_request(std::uint8_t system) {
    constexpr std::uint16_t set_message_interval = 511;  // MAV_CMD_SET_MESSAGE_INTERVAL
    Message message{command_long_kind, {}};
    PayloadWriter(message.payload)
        .f32(static_cast<float>(attitude_kind.id))
        .f32(static_cast<float>(attitude_interval_us))
        .f32(0)
        .f32(0)
        .f32(0)
        .f32(0)
        .f32(0)  // to whoever asks
        .u16(set_message_interval)
        .u8(system)
        .u8(autopilot_component)
        .u8(0);  // the first time
    return message;
}

}  // namespace disparityd::mavlink
