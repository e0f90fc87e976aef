// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "kernels/cpu/sgm_kernels.h"
#include "kernels/large_buffer.h"
#include "kernels/parallel.h"

namespace disparityd::cpu {

/// Steps 4 to 7 of docs/algorithm.md for SGM with 8 paths, in two passes over the image.
///
/// A downward sweep sums the four paths that come from the left and from above, an upward sweep the other four. They
/// meet in the middle: one worker sweeps the upper half down while another sweeps the lower half up, and each leaves
/// its sums; then they cross over into the other half, and with the sums of the other one at hand the winner of each
/// row is found in the same sweep. What is computed does not depend on who does it.
class SgmSweeps {
public:
    /// Allocates all memory. `cache_bytes`: volumes larger than this are written past the caches.
    SgmSweeps(int width, int height, const MatchOptions& options, std::int64_t target, std::size_t cache_bytes);

    /// What the census of a frame takes: bytes aligned to 64.
    std::size_t census_bytes() const;
    void census(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, std::span<std::byte> planes,
                Parallel& workers) const;

    /// `left` is looked at for adaptive P2 only.
    void match(std::span<const std::byte> planes, Plane<const std::uint8_t> left, const WinnerPlanes& results,
               Parallel& workers) const;

private:
    struct Sweep;

    /// One frame.
    struct Input {
        std::span<const std::byte> planes;
        Plane<const std::uint8_t> left;
    };

    void begin(const Sweep& sweep) const;
    void leave_sums(const Sweep& sweep, const Input& input) const;
    void find_winners(const Sweep& sweep, const Input& input, const WinnerPlanes& results) const;
    void set_jumps(const Sweep& sweep, const Input& input, int y, int i, SweepRow& row) const;
    Sweep sweep(int direction) const;
    const std::uint8_t* matching_cost(std::span<const std::byte> planes, int y, std::uint8_t* out) const;
    std::uint8_t* row_of(const LargeBuffer& volume, int y) const;

    MatchOptions options_;
    SgmKernels kernels_;
    SgmGeometry geometry_;
    bool stream_;
    bool keep_costs_;   // else they are computed again in the second sweep
    LargeBuffer sums_;  // four paths per pixel and candidate
    LargeBuffer costs_;
    LargeBuffer sweeps_;  // of each direction: rows of costs and sums in work, path costs of the row before
    std::size_t sweep_bytes_ = 0;
};

}  // namespace disparityd::cpu
