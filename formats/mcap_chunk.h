// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace disparityd::formats {

/// The largest record that is read, and the largest chunk unpacked: beyond the largest image. A damaged file must not
/// claim all memory.
inline constexpr std::uint64_t mcap_most_bytes = std::uint64_t{256} << 20U;

/// Returns the records within a chunk, unpacked into `room` where they are packed, else a view of `content`. Checks
/// size and checksum. Throws std::runtime_error with one line, which does not say where the chunk lies.
std::span<const std::uint8_t> mcap_chunk_records(std::span<const std::uint8_t> content,
                                                 std::vector<std::uint8_t>& room);

}  // namespace disparityd::formats
