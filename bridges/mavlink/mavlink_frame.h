// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace disparityd::mavlink {

/// What the definition of a message fixes.
struct MessageKind {
    std::uint32_t id = 0;  ///< 24 bits
    std::uint8_t crc_extra =
        0;                   ///< of the fields' names and types; a receiver with another definition drops the message
    std::size_t length = 0;  ///< of the payload with extensions, bytes
};

/// A message before it is framed.
struct Message {
    MessageKind kind;
    std::vector<std::uint8_t> payload;  ///< kind.length bytes: the fields in the order of the wire, little endian
};

/// Appends fields to a payload, little endian.
class PayloadWriter {
public:
    explicit PayloadWriter(std::vector<std::uint8_t>& payload) : payload_(payload) {}

    PayloadWriter& u8(std::uint8_t value) { return bytes(value, 1); }
    PayloadWriter& u16(std::uint16_t value) { return bytes(value, 2); }
    PayloadWriter& u32(std::uint32_t value) { return bytes(value, 4); }
    PayloadWriter& u64(std::uint64_t value) { return bytes(value, 8); }
    PayloadWriter& f32(float value);  ///< IEEE 754, single precision

private:
    PayloadWriter& bytes(std::uint64_t value, unsigned count);

    std::vector<std::uint8_t>& payload_;
};

inline constexpr std::uint16_t crc_start = 0xffff;

/// Returns CRC-16/MCRF4XX of the bytes. `before` is the CRC of what precedes them.
std::uint16_t crc(std::span<const std::uint8_t> bytes, std::uint16_t before = crc_start);

/// The first byte of a frame of MAVLink 2.
inline constexpr std::uint8_t frame_magic = 0xfd;

/// What a frame adds to the payload at most, bytes.
inline constexpr std::size_t around_payload = 12;

/// Frames the messages of one component of one system: MAVLink 2, without signature.
class FrameWriter {
public:
    FrameWriter(std::uint8_t system, std::uint8_t component) : system_(system), component_(component) {}

    /// Returns the bytes to send, at most around_payload more than the payload. Each call takes the next sequence
    /// number, so a frame that is not sent counts as lost at the receiver. Throws std::logic_error for a payload that
    /// is not as long as its kind says.
    std::vector<std::uint8_t> frame(const Message& message);

private:
    std::uint8_t system_;
    std::uint8_t component_;
    std::uint8_t sequence_ = 0;
};

}  // namespace disparityd::mavlink
