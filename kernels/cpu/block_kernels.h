// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/cost/matching_cost_kernel.h"
#include "kernels/cpu/match_layout.h"

namespace disparityd::cpu {

/// Winner-takes-all on costs of single windows, for one instruction set and number of candidates: pure functions on
/// rows of an image. `geometry` has the layout of sgm_kernels().
struct BlockKernels {
    /// Bytes of memory that sad() and census() need for one band of rows, aligned to 64.
    std::size_t (*scratch_bytes)(const MatchGeometry& geometry);

    /// Steps 2, 6, 7 and 13 for rows [first, last).
    void (*sad)(const MatchGeometry& geometry, const PostOptions& options, Plane<const std::uint8_t> left,
                Plane<const std::uint8_t> right, Rows rows, std::uint8_t* scratch, const WinnerPlanes& out);

    /// Steps 4, 6, 7 and 13 for rows [first, last) from census planes of all rows and the kernel that their cost has.
    void (*census)(const MatchGeometry& geometry, const PostOptions& options, MatchingCostKernel matching_cost,
                   CensusPlanes<const std::uint8_t> planes, Rows rows, std::uint8_t* scratch, const WinnerPlanes& out);
};

BlockKernels block_kernels(std::int64_t target, int disparities);

}  // namespace disparityd::cpu
