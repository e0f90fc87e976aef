// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace disparityd::formats {

/// Unpack a chunk of a bag into all of `room`, which has the size that the file states. Each throws std::runtime_error
/// with one line, which does not say where the chunk lies, for data that are damaged or are not of this size.
void unpack_zstd(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room);
void unpack_lz4(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room);  ///< frames of LZ4
void unpack_bz2(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room);  ///< at most 4 GiB

/// Unpacks a message that is a frame of zstd into `room`, of the size that the frame states: at most 256 MiB. Throws as
/// the others.
void unpack_zstd_message(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room);

/// Returns, for a message, the command that unpacks a file which zstd has packed, beside it.
std::string zstd_command(const std::string& path);

}  // namespace disparityd::formats
