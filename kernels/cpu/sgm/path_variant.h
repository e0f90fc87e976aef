// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::cpu {

/// Which paths are aggregated, and how large numbers can become.
struct PathVariant {
    bool diagonals = true;  ///< 8 paths, else the 4 along rows and columns
    bool any_p2 = false;    ///< P2 up to 193; else up to 63
    bool u16_sums = false;  ///< the sums of a sweep are words, else bytes
    bool adds = false;      ///< to the sums that the other sweep left

    constexpr int sum_bytes() const { return u16_sums ? 2 : 1; }

    /// Whether the sums of both sweeps fit a byte together: of four paths they are 4 * 63 = 252 at most.
    constexpr bool may_add() const { return !diagonals && !u16_sums; }
    constexpr PathVariant adding() const { return {diagonals, any_p2, u16_sums, true}; }
};

/// 8 paths while four of them add up to 4 * 63 = 252 at most.
constexpr PathVariant eight_paths_u8_sums{true, false, false};
constexpr PathVariant eight_paths_u16_sums{true, true, true};

/// 4 paths, with the same P2: the two of a sweep would leave room for more, but its steps could not be those of
/// path_offsets-inl.h.
constexpr PathVariant four_paths_u8_sums{false, false, false};
constexpr PathVariant four_paths_u16_sums{false, true, true};

}  // namespace disparityd::cpu
