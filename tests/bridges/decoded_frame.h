// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridges/mavlink/obstacle_message.h"

namespace disparityd::test {

/// A MAVLink 2 frame, taken apart again.
struct DecodedFrame {
    std::uint8_t sequence = 0;
    std::uint8_t system = 0;
    std::uint8_t component = 0;
    std::uint32_t id = 0;
    std::vector<std::uint8_t> payload;  ///< with the zeros at the end that were not sent

    std::uint64_t number(std::size_t offset, std::size_t bytes) const;  ///< little endian
    float real(std::size_t offset) const;

    /// Of OBSTACLE_DISTANCE.
    mavlink::SectorDistances distances() const;
};

/// Returns the frame when the bytes are exactly one, of a kind that the bridge sends and with a right checksum.
std::optional<DecodedFrame> decode(std::span<const std::uint8_t> bytes);

/// Takes whole frames from the start of a stream of bytes, and them away from it. What is no frame stays.
std::vector<DecodedFrame> take_frames(std::vector<std::uint8_t>& stream);

}  // namespace disparityd::test
