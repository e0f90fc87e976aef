// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/path_costs.h"
#include "kernels/cuda/volume.h"
#include "kernels/cuda/winner_row.h"

namespace disparityd::cuda {

namespace {

// 8 C, or 4 C, and what every path adds: that of this path is in L already. An idle slot stays unreachable.
template <int packs>
__device__ void add_costs(const PathCosts<packs>& path, const Costs<packs>& costs, int other_paths,
                          Costs<packs>& sums) {
    constexpr U16x2 reachable_costs = 0x003f003f;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        sums[p] = path.cost[p] + (costs[p] & reachable_costs) * static_cast<unsigned>(other_paths);
    }
}

template <int packs>
__device__ void add_volume(const std::uint8_t* volume, std::ptrdiff_t pixel, bool wide, Costs<packs>& sums) {
    Costs<packs> added;
    load<packs>(volume + pixel * pixel_bytes(packs, wide), wide, added);
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        sums[p] += added[p];
    }
}

// Of the pixels that come when those of now are done.
template <int packs>
__device__ void prefetch_volume(const std::uint8_t* volume, std::ptrdiff_t row, int x, int width, bool wide) {
    constexpr int pixels = slots_of(packs);
    const int ahead = min(x + pixels, width - 1);
    const int last = min(x + 2 * pixels, width) - 1;
    const int bytes = pixel_bytes(packs, wide);
    const int step = lane_index() * (pixels * bytes / lanes);
    prefetch(volume + (row + ahead) * bytes + min(step, (last - ahead) * bytes));
}

// The path to the right, the last one: its costs stay in registers, the others' are added to them, and the sums are
// used up on the spot. A sum of path costs is stored nowhere.
template <Cost cost, int packs, bool adaptive>
__global__ void __launch_bounds__(block_rows* lanes) sgm_winners_kernel(PathsJob job, WinnerJob winner) {
    DISPARITYD_SHARED(WinnerBatch<packs>, batches, [block_rows]);
    const int y = row_of_warp();
    if (y >= job.image.height) {
        return;
    }
    const int width = job.image.width;
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width;
    const CandidateBounds<packs> bounds(job.range, width);
    WordsAlongRow<cost, packs, 1> words(words_of<cost>(job.words.right) + row, bounds, 0);
    const PathPenalties penalties(job.p1);
    PathCosts<packs> path;
    WinnerRow<packs> winners(winner, y, batches[threadIdx.y]);
    winners.walk([&](int x, int phase, Costs<packs>& sums) {
        if (phase == 0) {
            prefetch_volume<packs>(job.left_volume, row, x, width, false);
            prefetch_volume<packs>(job.sweep_volume[0], row, x, width, job.wide);
            prefetch_volume<packs>(job.sweep_volume[1], row, x, width, job.wide);
        }
        Costs<packs> costs;
        words.next(words_of<cost>(job.words.left)[row + x], x, phase, costs);
        const U16x2 p2 = adapted_p2<adaptive>(job, {x - 1, y}, {x, y});
        path = continued<packs>(penalties, path, costs, p2);
        add_costs<packs>(path, costs, job.paths - 1, sums);
        add_volume<packs>(job.left_volume, row + x, false, sums);
        add_volume<packs>(job.sweep_volume[0], row + x, job.wide, sums);
        add_volume<packs>(job.sweep_volume[1], row + x, job.wide, sums);
    });
}

}  // namespace

void sgm_winners(const PathsJob& paths, const WinnerJob& winner, cudaStream_t stream) {
    with_variant(paths, [&](auto cost, auto packs, auto adaptive) {
        launch("SGM winners", rows_shape(paths.image.height), stream,
               sgm_winners_kernel<decltype(cost)::value, decltype(packs)::value, decltype(adaptive)::value>, paths,
               winner);
    });
}

}  // namespace disparityd::cuda
