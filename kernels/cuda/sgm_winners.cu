// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/path_costs.h"
#include "kernels/cuda/winner_row.h"

namespace disparityd::cuda {

namespace {

// The path to the right, the last one: its costs stay in registers, the others' are added to them, and the sums are
// used up on the spot. A sum of path costs is stored nowhere.
template <int packs>
__global__ void __launch_bounds__(block_rows* lanes) sgm_winners_kernel(PathsJob job, WinnerJob winner) {
    const int y = row_of_warp();
    const int width = job.image.width;
    if (y >= job.image.height) {
        return;
    }
    const std::size_t volume = volume_bytes<packs>(width, job.image.height);
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width;
    Costs<packs> idle;
    idle_slots<packs>(job.range.count, idle);
    PathCosts<packs> path;
    WinnerRow<packs> winners(winner, y);
    int intensity_before = 0;
    for (int x = 0; x < width; ++x) {
        Costs<packs> costs;
        census_costs<packs>(job.words.left[row + x], job.words.right + row + x, width, x, job.range.first, costs);
        const int intensity = job.image.at(x, y);
        if (x == 0) {
            begin_path<packs>(costs, idle, path);
        } else {
            const int p2 = adapted_p2(job.p1, job.p2, job.adaptive_p2, intensity, intensity_before);
            continue_path<packs>(costs, idle, job.p1, p2, path);
        }
        intensity_before = intensity;
        Costs<packs> sums;
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            sums[p] = path.cost[p];
        }
        const std::uint8_t* pixel = job.volumes + (row + x) * pixel_bytes(packs);
        for (int other = 0; other < job.paths - 1; ++other) {
            add_path<packs>(pixel + static_cast<std::size_t>(other) * volume, sums);
        }
        winners.next(sums);
    }
    winners.finish();
}

}  // namespace

void aggregate_and_choose(const PathsJob& paths, const WinnerJob& winner, cudaStream_t stream) {
    with_packs(paths.range.count, [&](auto packs) {
        launch("aggregate and choose", rows_shape(paths.image.height), stream,
               sgm_winners_kernel<decltype(packs)::value>, paths, winner);
    });
}

}  // namespace disparityd::cuda
