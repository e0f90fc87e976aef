// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/large_buffer.h"

namespace disparityd::cpu {

constexpr int max_rows_at_once = 2;

/// The memory of a worker while it works on a group of rows.
struct WorkerScratch {
    std::uint8_t* costs[max_rows_at_once] = {};
    std::uint8_t* sums[max_rows_at_once] = {};
    std::uint8_t* p2_rows[max_rows_at_once][4] = {};  ///< none of its own unless P2 is adaptive
    SingleRowCosts* single = nullptr;                 ///< for SgmKernels::matching_cost
};

/// The memory of both sweeps, all of it allocated once.
class SweepMemory {
public:
    SweepMemory(const MatchGeometry& geometry, const SgmKernels& kernels, const SgmOptions& options);

    /// Rows of the volumes.
    std::uint8_t* sums(int y) const { return row_of(sums_, sums_row_, y); }
    std::uint8_t* costs(int y) const { return row_of(costs_, costs_row_, y); }

    /// Of sweep 0 or 1; cleared, it is the row outside the image: a path adds nothing there, L = least = 0.
    PathRow path_row(int sweep) const;
    void clear_path_row(int sweep) const;

    /// How many workers there is memory for, 2 at least.
    int scratch_count() const { return scratch_count_; }
    WorkerScratch scratch(int i) const;

    /// At the beginning of a frame: what workers have of single rows is of another one.
    void forget_single_rows() const;

private:
    static std::uint8_t* row_of(const LargeBuffer& volume, std::size_t row_bytes, int y) {
        return reinterpret_cast<std::uint8_t*>(volume.data()) + static_cast<std::size_t>(y) * row_bytes;
    }
    std::uint8_t* path_costs(int sweep) const;
    std::uint8_t* path_min(int sweep) const;

    std::size_t costs_row_;
    std::size_t sums_row_;
    std::size_t candidates_;
    std::size_t path_pixels_;  // positions of a sweep with guards
    std::size_t path_array_;   // path costs of one path
    std::size_t path_bytes_;   // path rows of one sweep
    int rows_at_once_;
    bool adaptive_;
    std::size_t single_bytes_;  // of SingleRowCosts, where costs are averaged
    std::size_t scratch_bytes_;
    int scratch_count_;
    LargeBuffer sums_;
    LargeBuffer costs_;
    LargeBuffer paths_;
    LargeBuffer p2_row_;  // P2 for a whole row, where it is the same everywhere
    LargeBuffer scratch_memory_;
    std::unique_ptr<SingleRowCosts[]> single_;  // one for each scratch, where costs are averaged
};

}  // namespace disparityd::cpu
