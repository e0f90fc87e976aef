// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace disparityd::capture {

/// The place of the Segment, the one large element of a Matroska file. Its size tells whether the file was closed (a
/// writer at work leaves it "unknown") and whether it is whole.
struct MatroskaSegment {
    std::uint64_t size_offset = 0;      ///< of the size field, from the start of the file
    int size_length = 0;                ///< bytes of the size field
    std::uint64_t data_offset = 0;      ///< of the first byte after it
    std::optional<std::uint64_t> size;  ///< bytes from data_offset on; empty = unknown
};

/// Finds the Segment in the first bytes of a file (a few hundred suffice); empty when this is not Matroska.
std::optional<MatroskaSegment> find_segment(std::span<const std::uint8_t> head);

}  // namespace disparityd::capture
