// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/sgm/sweep_memory.h"
#include "kernels/cpu/sgm/sweep_plan.h"
#include "kernels/parallel.h"

namespace disparityd::cpu {

/// A pair and what of it is smoothed, which is missing where no noise level is.
struct SmoothedPair {
    Plane<const std::uint8_t> left;
    Plane<const std::uint8_t> right;
    Plane<const std::uint8_t> smoothed_left = {};
    Plane<const std::uint8_t> smoothed_right = {};
};

/// Steps 4 to 7 of docs/algorithm.md for SGM, in two passes over the image.
///
/// A downward sweep sums the paths that come from the left and from above, an upward sweep the others. They meet in the
/// middle: the upper half is swept down while the lower half is swept up, and each sweep stores its sums; then they
/// cross over into the other half, and with the sums of the other one at hand the winner of each row is found in the
/// same sweep. Within a sweep several workers take a row each: matching costs and winners depend on no other row, and
/// the paths of a row run some columns behind those of the previous row. What is computed does not depend on who does
/// it.
class SgmSweeps {
public:
    /// Allocates all memory. `cache_bytes`: volumes larger than half of this are written past the caches.
    SgmSweeps(int width, int height, const MatchOptions& options, std::int64_t target, std::size_t cache_bytes);
    /// With other kernels than those that path_kernels() has for the target.
    SgmSweeps(int width, int height, const MatchOptions& options, const SgmKernels& kernels, std::size_t cache_bytes);

    /// What the census of a frame takes: bytes aligned to 64.
    std::size_t census_bytes() const;
    void census(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, std::span<std::byte> memory,
                Parallel& workers) const;
    /// The same at a noise level of this coarseness, 1 or 2.
    void noisy_census(const SmoothedPair& pair, int coarseness, std::span<std::byte> memory, Parallel& workers) const;

    /// `guide` is looked at for adaptive P2 only: the left image, or that smoothed. `options` are those of before, or
    /// those at_noise_level(). One frame at a time.
    void match(std::span<const std::byte> census, Plane<const std::uint8_t> guide, const MatchOptions& options,
               const WinnerPlanes& results, Parallel& workers) const;

private:
    struct Frame;

    void census_of(const CensusKernels& kernels, const SmoothedPair& pair, std::span<std::byte> memory,
                   Parallel& workers) const;
    std::size_t bytes_of_volumes() const;
    void work(Frame& frame, int groups) const;
    void store_sums(Frame& frame, const RowGroup& group, const WorkerScratch& scratch) const;
    void find_winners(Frame& frame, const RowGroup& group, const WorkerScratch& scratch) const;
    void aggregate(Frame& frame, const RowGroup& group, const SweepPass& pass, const SweepRow* rows, int count) const;
    void set_p2_rows(const Frame& frame, int direction, int y, std::uint8_t* const* p2_rows, SweepRow& row) const;
    /// The row that follows row i of these in this worker's next group.
    int row_ahead(const Frame& frame, const SweepRows& rows, int i) const;
    /// Of row i of these.
    void matching_cost(const Frame& frame, const SweepRows& rows, int i, const WorkerScratch& scratch,
                       std::uint8_t* costs, std::uint8_t* streamed) const;

    SgmKernels kernels_;
    MatchGeometry geometry_;
    bool stream_;
    SweepMemory memory_;
};

}  // namespace disparityd::cpu
