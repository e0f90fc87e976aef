// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace disparityd::frames {

/// Returns a PNG of one grey channel of 16 bits. `pixels` are little endian, row by row without gaps: 2 * width *
/// height bytes; width and height are 1 or more. It is made for speed, not for size. Each thread has a compressor of
/// its own. Throws std::bad_alloc and nothing else.
std::string png16_of(std::span<const std::uint8_t> pixels, std::uint32_t width, std::uint32_t height);

}  // namespace disparityd::frames
