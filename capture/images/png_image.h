// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace disparityd::capture {

/// Returns a PNG without the chunks that say nothing about its pixels (colour profiles, texts, times), of which the
/// decoder would write warnings of its own to stderr. Throws std::invalid_argument with one line, for which `path` is,
/// where the file was cut off or a checksum of it is wrong.
std::vector<std::uint8_t> checked_png(std::span<const std::uint8_t> file, const std::string& path);

}  // namespace disparityd::capture
