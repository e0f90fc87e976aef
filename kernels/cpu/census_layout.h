// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace disparityd::cpu {

/// Census words of both images as planes of bytes, row by row: plane i of a row holds some bits of every pixel's word,
/// 8 of them, or 4 where the machine counts bits by table. Or as one plane, of the words themselves, 8 bytes each.
struct CensusLayout {
    int planes = 0;
    int left_pitch = 0;   ///< bytes from plane to plane of a row, left image
    int right_part = 0;   ///< right image: bytes of each of the `registers` parts of a plane
    int right_pitch = 0;  ///< bytes from plane to plane

    std::size_t left_row() const { return static_cast<std::size_t>(planes) * static_cast<std::size_t>(left_pitch); }
    std::size_t right_row() const { return static_cast<std::size_t>(planes) * static_cast<std::size_t>(right_pitch); }
    /// Of all rows of both images.
    std::size_t bytes(int height) const { return static_cast<std::size_t>(height) * (left_row() + right_row()); }
};

/// The planes of one row of each image.
struct CensusRow {
    const std::uint8_t* left = nullptr;
    const std::uint8_t* right = nullptr;
};

/// The planes of all rows: those of the left image, after them those of the right one. `Byte` is std::uint8_t or const.
template <typename Byte>
struct CensusPlanes {
    /// In CensusLayout::bytes() of memory.
    CensusPlanes(const CensusLayout& layout, int height, Byte* memory)
        : left(memory), right(memory + static_cast<std::size_t>(height) * layout.left_row()) {}
    CensusPlanes(Byte* of_left, Byte* of_right) : left(of_left), right(of_right) {}

    CensusRow row(const CensusLayout& layout, int y) const {
        const auto rows_before = static_cast<std::size_t>(y);
        return {left + rows_before * layout.left_row(), right + rows_before * layout.right_row()};
    }

    Byte* left;
    Byte* right;
};

}  // namespace disparityd::cpu
