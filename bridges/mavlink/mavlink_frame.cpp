// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/mavlink_frame.h"

#include <bit>
#include <stdexcept>

namespace disparityd::mavlink {
namespace {

/// Returns the length without the zeros at the end, which are not sent; the first byte always is.
std::size_t sent_length(std::span<const std::uint8_t> payload) {
    std::size_t length = payload.size();
    while (length > 1 && payload[length - 1] == 0) {
        --length;
    }
    return length;
}

}  // namespace

PayloadWriter& PayloadWriter::bytes(std::uint64_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
        payload_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return *this;
}

PayloadWriter& PayloadWriter::f32(float value) {
    return u32(std::bit_cast<std::uint32_t>(value));
}

std::uint16_t crc(std::span<const std::uint8_t> bytes, std::uint16_t before) {
    constexpr unsigned polynomial = 0x8408;  // 0x1021, the lowest bit first
    unsigned value = before;
    for (const std::uint8_t byte : bytes) {
        value ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            value = (value & 1) != 0 ? (value >> 1) ^ polynomial : value >> 1;
        }
    }
    return static_cast<std::uint16_t>(value);
}

std::vector<std::uint8_t> FrameWriter::frame(const Message& message) {
    if (message.payload.size() != message.kind.length || message.payload.size() > 255 || message.payload.empty()) {
        throw std::logic_error("a MAVLink payload has another length than its definition");
    }
    const std::size_t length = sent_length(message.payload);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(length + around_payload);
    PayloadWriter(bytes)
        .u8(frame_magic)
        .u8(static_cast<std::uint8_t>(length))
        .u8(0)  // nothing that a receiver must understand: no signature
        .u8(0)  // nor what it may ignore
        .u8(sequence_++)
        .u8(system_)
        .u8(component_)
        .u16(static_cast<std::uint16_t>(message.kind.id))
        .u8(static_cast<std::uint8_t>(message.kind.id >> 16));
    bytes.insert(bytes.end(), message.payload.begin(), message.payload.begin() + static_cast<std::ptrdiff_t>(length));
    const std::uint16_t sum = crc(std::span(&message.kind.crc_extra, 1), crc(std::span(bytes).subspan(1)));
    PayloadWriter(bytes).u16(sum);
    return bytes;
}

}  // namespace disparityd::mavlink
