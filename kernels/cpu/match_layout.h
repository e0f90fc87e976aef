// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/census_layout.h"
#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::cpu {

/// How the candidates of a pixel lie in vector registers. Candidate k = registers * lane + r is in lane `lane` of
/// register r. With 3 registers of n lanes:
///
///                   lane 0   lane 1   lane 2   lane 3        lane n - 1
///     register 0       0        3        6        9     ..     3n - 3
///     register 1       1        4        7       10     ..     3n - 2
///     register 2       2        5        8       11     ..     3n - 1
///
/// So the neighbours k - 1 and k + 1 of a whole register are two other registers. Only the first and the last register
/// need a shift by one lane: k - 1 of register 0 is register 2, each lane taken from the lane below.
///
/// Sums are words of 16 bits: the even lanes of the registers one after the other, then their odd lanes. Candidate k is
/// then in the vector of its residue q = k mod stride, stride = 2 * registers, in lane k / stride:
///
///                   lane 0   lane 1        lane n / 2 - 1
///     residue 0        0        6     ..      3n - 6        even lanes of register 0
///     residue 1        1        7     ..      3n - 5        even lanes of register 1
///     residue 2        2        8     ..      3n - 4        even lanes of register 2
///     residue 3        3        9     ..      3n - 3        odd lanes of register 0
///     residue 4        4       10     ..      3n - 2        odd lanes of register 1
///     residue 5        5       11     ..      3n - 1        odd lanes of register 2
///
/// `lanes * registers` is the number of candidates rounded up. What is too much costs `padding_cost`, which never wins
/// and never influences its neighbours.
struct DisparityLayout {
    int lanes = 0;
    int registers = 0;

    int candidates() const { return lanes * registers; }
    std::size_t bytes() const { return static_cast<std::size_t>(candidates()); }
};

/// What is walked side by side begins at places of a page that lie so far apart. In whole pages (an image of 1280 x 128
/// disparities has such rows) it would compete for the same few lines of the first-level cache, and a load seems to
/// depend on every store that is whole pages away.
constexpr std::size_t spread_page = 4096;
constexpr std::size_t spread_shift = 832;

/// Returns the bytes from one array of `size` bytes to the next.
constexpr std::size_t spread(std::size_t size) {
    return (size + spread_page - 1) / spread_page * spread_page + spread_shift;
}

/// Returns the bytes from one row of `size` bytes to the next; as they are many, no more than it takes.
constexpr std::size_t spread_pitch(std::size_t size) {
    const std::size_t beyond = size % spread_page;
    if (beyond < spread_shift) {
        return spread(size - beyond);
    }
    return beyond > spread_page - spread_shift ? spread(size) : size;
}

/// Least cost that is out of reach of all others: 62 (largest cost) + 63 (largest P2), and a little. Kernels for a
/// larger P2 see to padding themselves.
constexpr std::uint8_t padding_cost = 128;

/// What stays the same for all rows of a frame.
struct MatchGeometry {
    int width = 0;
    int height = 0;
    DisparityRange range;
    DisparityLayout layout;
    CensusLayout census;
    int cost_bias = 0;  ///< added to each matching cost in memory

    std::size_t row_bytes() const { return static_cast<std::size_t>(width) * layout.bytes(); }
};

/// Rows of results.
struct WinnerRow {
    std::int16_t* winner = nullptr;
    std::int16_t* disparity = nullptr;
    std::uint8_t* confidence = nullptr;
    std::int16_t* right_winner = nullptr;
};

/// Where results go; all planes have the size of the image.
struct WinnerPlanes {
    Plane<std::int16_t> disparity;
    Plane<std::uint8_t> confidence;
    Plane<std::int16_t> winner;
    Plane<std::int16_t> right_winner;

    WinnerRow row(int y) const { return {winner.row(y), disparity.row(y), confidence.row(y), right_winner.row(y)}; }
};

}  // namespace disparityd::cpu
