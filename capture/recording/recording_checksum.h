// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/raw_image.h"

/// The checksums that stand at the end of a frame's block addition (docs/recordings.md). The codec has none of its own,
/// and a flipped bit of its data is another picture.
namespace disparityd::capture::recording {

inline constexpr std::size_t checksums_size = 8;

/// Returns the CRC-32 of IEEE 802.3, as zlib's crc32() does.
std::uint32_t checksum(std::span<const std::uint8_t> bytes);

/// Returns that of the pixels of both eyes, without the gaps between rows.
std::uint32_t checksum(const RawImage& image);

/// Writes both checksums to the last checksums_size bytes: that of the picture (pixels or JPEG), and that of all bytes
/// before its own.
void put_checksums(std::uint32_t picture, std::span<std::uint8_t> addition);

/// What the end of a block addition says.
struct StoredChecksums {
    bool addition_is_whole = false;
    std::uint32_t picture = 0;
};

/// Reads the checksums of an addition that ends with them; nothing where it is too short.
std::optional<StoredChecksums> get_checksums(std::span<const std::uint8_t> addition);

}  // namespace disparityd::capture::recording
