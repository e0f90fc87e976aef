// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace simulated_camera {

/// The frame that has this number, for a frame of any even size: the number itself, little endian, in the first four
/// bytes; every later group of four depends on the number and on its place. The same size and number always give the
/// same bytes, so who receives a frame can tell whether it is whole.
void fill_pattern(std::uint32_t number, std::span<std::uint8_t> frame);

/// One byte of such a frame.
std::uint8_t pattern_byte(std::uint32_t number, std::size_t index);

/// The number that a frame claims to have.
std::uint32_t pattern_number(std::span<const std::uint8_t> frame);

/// Index of the first byte that is not as fill_pattern() makes it for the number that the frame claims, or -1.
std::ptrdiff_t first_difference_from_pattern(std::span<const std::uint8_t> frame);

}  // namespace simulated_camera
