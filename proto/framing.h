// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "proto/disparity.pb.h"

/// Framing of the socket protocol: u32 length (little endian) | Envelope | payload. Nothing here keeps state or does
/// I/O; any thread may call it.
namespace disparityd::proto {

/// What both sides say in Hello and Welcome; docs/protocol.md has the rule for other versions.
inline constexpr std::uint32_t protocol_version = 1;

/// Bytes of the length in front of each Envelope.
inline constexpr std::size_t length_bytes = 4;

/// A longer Envelope is refused by both sides before anything is allocated for it.
inline constexpr std::uint32_t max_envelope_bytes = 1U << 20;

/// The largest width or height of an image, and the most bytes that may follow one Envelope, that a client accepts.
inline constexpr std::uint32_t max_image_side = 16384;
inline constexpr std::uint64_t max_payload_bytes = 512ULL << 20;

/// Replaces `out` by length and Envelope; the payload, of envelope.payload_bytes() bytes, is for the caller to send
/// after it. The buffer's memory is used again. Throws std::invalid_argument when the Envelope is too long.
void encode(const v1::Envelope& envelope, std::vector<std::uint8_t>& out);

/// The length of the Envelope that follows. Throws std::invalid_argument when it is above `limit`.
std::uint32_t decode_length(std::span<const std::uint8_t, length_bytes> bytes,
                            std::uint32_t limit = max_envelope_bytes);

/// Replaces `envelope` by what the bytes say. Throws std::invalid_argument when they are no Envelope.
void decode(std::span<const std::uint8_t> bytes, v1::Envelope& envelope);

/// Bytes of a plane before compression. Throws std::invalid_argument when a size is 0 or above the limits.
std::uint64_t raw_plane_bytes(const v1::PlaneInfo& plane);

}  // namespace disparityd::proto
