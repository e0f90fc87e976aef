// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/path_costs.h"
#include "kernels/cuda/strips.h"

namespace disparityd::cuda {

namespace {

constexpr int block_lines = 4;  // warps of a block

// The path to the left, a warp for each row.
template <Cost cost, int packs, bool adaptive>
__global__ void __launch_bounds__(block_lines* lanes) path_to_left_kernel(PathsJob job) {
    constexpr int slots = slots_of(packs);
    const int y = static_cast<int>(blockIdx.x) * block_lines + warp_index();
    if (y >= job.image.height) {
        return;
    }
    const int width = job.image.width;
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width;
    const CandidateBounds<packs> bounds(job.range, width);
    WordsAlongRow<cost, packs, -1> words(words_of<cost>(job.words.right) + row, bounds, width - 1);
    const PathPenalties penalties(job.p1);
    PathCosts<packs> path;
    for (int x0 = width - 1; x0 >= 0; x0 -= slots) {
#pragma unroll
        for (int phase = 0; phase < slots; ++phase) {
            const int x = x0 - phase;
            if (x < 0) {
                return;
            }
            Costs<packs> costs;
            words.next(words_of<cost>(job.words.left)[row + x], x, phase, costs);
            const U16x2 p2 = adapted_p2<adaptive>(job, {x + 1, y}, {x, y});
            path = continued<packs>(penalties, path, costs, p2);
            Costs<packs> added;
#pragma unroll
            for (int p = 0; p < packs; ++p) {
                added[p] = path.cost[p] - costs[p];
            }
            store_bytes<packs>(job.left_volume + (row + x) * pixel_bytes(packs, false), added);
        }
    }
}

}  // namespace

std::size_t volume_bytes(int width, int height, int disparities) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
           static_cast<std::size_t>(pixel_bytes(packs_for(disparities), false));
}

SgmBytes sgm_bytes(int width, int height, int disparities, int paths, int p2) {
    const bool diagonals = paths == 8;
    const std::size_t volume = volume_bytes(width, height, disparities);
    const int packs = packs_for(disparities);
    const auto strips = static_cast<std::size_t>(2 * strips_of_sweep(width, height, packs));
    const std::size_t edge = static_cast<std::size_t>(height) * static_cast<std::size_t>(edge_bytes(packs));
    return {volume, is_wide(paths, p2) ? 2 * volume : volume, diagonals ? strips * edge : 0,
            diagonals ? (1 + strips) * sizeof(int) : 0};
}

void path_to_left(const PathsJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.image.height, block_lines)), dim3(lanes, block_lines)};
    with_variant(job, [&](auto cost, auto packs, auto adaptive) {
        launch("path to the left", shape, stream,
               path_to_left_kernel<decltype(cost)::value, decltype(packs)::value, decltype(adaptive)::value>, job);
    });
}

}  // namespace disparityd::cuda
