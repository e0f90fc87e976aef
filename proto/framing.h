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

/// The version that both sides send in Hello and Welcome; docs/protocol.md has the rule for other versions.
inline constexpr std::uint32_t protocol_version = 2;

/// Bytes of the length in front of each Envelope.
inline constexpr std::size_t length_bytes = 4;

/// Both sides refuse a longer Envelope before they allocate anything for it.
inline constexpr std::uint32_t max_envelope_bytes = 1U << 20;

/// The daemon refuses a longer one of a client: nothing that a client says needs more.
inline constexpr std::uint32_t max_client_envelope_bytes = 64U << 10;

/// A client accepts images of at most this width or height, and at most so many bytes after one Envelope.
inline constexpr std::uint32_t max_image_side = 16384;
inline constexpr std::uint64_t max_payload_bytes = 512ULL << 20;

/// Replaces `out` by length and Envelope, and reuses its memory. The caller sends the payload of
/// envelope.payload_bytes() bytes after it. Throws std::invalid_argument when the Envelope is too long.
void encode(const v1::Envelope& envelope, std::vector<std::uint8_t>& out);

/// Returns the length of the Envelope that follows. Throws std::invalid_argument when it is above `limit`.
std::uint32_t decode_length(std::span<const std::uint8_t, length_bytes> bytes,
                            std::uint32_t limit = max_envelope_bytes);

/// Parses the bytes into `envelope`. Throws std::invalid_argument when they are no Envelope.
void decode(std::span<const std::uint8_t> bytes, v1::Envelope& envelope);

/// Returns the bytes of a plane before compression. Throws std::invalid_argument when a size is 0 or above the limits.
std::uint64_t raw_plane_bytes(const v1::PlaneInfo& plane);

}  // namespace disparityd::proto
