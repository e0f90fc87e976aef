// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/cpu/match_layout.h"

namespace disparityd::cpu {

/// Where matching costs are averages over three rows (step 4 of docs/algorithm.md): the costs C0 of single rows that a
/// worker has computed last. It goes from row to row, so two of the three are there already. One thread at a time.
class SingleRowCosts {
public:
    SingleRowCosts() = default;
    /// In bytes() of memory, aligned to 64.
    SingleRowCosts(const MatchGeometry& geometry, std::uint8_t* memory)
        : row_bytes_(spread_pitch(geometry.row_bytes())), memory_(memory) {}

    static std::size_t bytes(const MatchGeometry& geometry) { return rows * spread_pitch(geometry.row_bytes()); }

    /// For the next frame.
    void forget() { held_.fill(nothing); }

    bool has(int y) const { return held_[place(y)] == y; }

    /// The costs of row y: biased like all matching costs, candidates outside the image and padding undefined.
    const std::uint8_t* of(int y) const { return memory_ + place(y) * row_bytes_; }

    /// Where to put those of row y, which counts as there from now on. Two rows side by side have a place each: a row
    /// takes that of the one on the other side of its neighbour.
    std::uint8_t* put(int y) {
        held_[place(y)] = y;
        return memory_ + place(y) * row_bytes_;
    }

private:
    static constexpr std::size_t rows = 2;
    static constexpr int nothing = -1;

    static std::size_t place(int y) { return static_cast<std::size_t>(y) % rows; }

    std::size_t row_bytes_ = 0;
    std::uint8_t* memory_ = nullptr;
    std::array<int, rows> held_ = {nothing, nothing};
};

}  // namespace disparityd::cpu
