// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
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

/// What is whole in a file that ends anywhere.
struct MatroskaPart {
    std::uint64_t end = 0;  ///< of the last whole block, from the start of the file
    std::uint64_t frames = 0;
    /// The size field of the cluster that block is in, where it must say less: the cluster was not written to its end.
    struct Correction {
        std::uint64_t offset = 0;  ///< from the start of the file
        int length = 0;            ///< bytes of the field
        std::uint64_t size = 0;
    };
    std::optional<Correction> cluster;
};

/// Copies bytes of a file from an offset on and returns how many there were.
using ReadBytes = std::function<std::size_t(std::uint64_t offset, std::span<std::uint8_t> bytes)>;

/// Finds the last whole block from `begin` on, where an element of the Segment begins (its data, a cluster). `size` is
/// that of the file. Of elements that are no clusters nothing is kept behind the last block.
MatroskaPart find_whole_part(const ReadBytes& read, std::uint64_t begin, std::uint64_t size);

/// Writes a size as EBML does, into all of `field`, of 1 to 8 bytes; it must fit.
void put_ebml_size(std::uint64_t size, std::span<std::uint8_t> field);

}  // namespace disparityd::capture
