// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace disparityd::frames {

/// Compresses depths without loss as RVL does (A. D. Wilson, Fast Lossless Depth Image Compression, 2017): runs of
/// zeros and of others take turns, first the length of each; of the others come the differences from the one before.
/// `depths` are little endian and have 16 bits, row by row; at most 2^32 - 1 of them. Four little endian bytes hold 8
/// nibbles, the first one in the highest bits; what is left of the last word is 0. Throws nothing but for want of
/// memory.
std::string rvl_of(std::span<const std::uint8_t> depths);

}  // namespace disparityd::frames
