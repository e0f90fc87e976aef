// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

/// The path costs L of one pixel of a line, step 5, held by a warp. A path that begins continues one that cost nothing.
template <int packs>
struct PathCosts {
    Costs<packs> cost = {};
    Pair least = 0;  ///< in both halves
};

template <int packs>
__device__ void find_least(PathCosts<packs>& path) {
    Pair least = path.cost[0];
#pragma unroll
    for (int p = 1; p < packs; ++p) {
        least = lesser(least, path.cost[p]);
    }
    // With the lesser number in both halves the least of the whole words is the least in both halves.
    path.least = least_of_warp(lesser(least, __byte_perm(least, 0, 0x1032)));
}

/// What is the same for all pixels: P1 in both halves, and how a lane takes its neighbours' ends. The first and the
/// last candidate stand for the neighbours that they do not have: with a penalty they are no less than themselves.
class Recursion {
public:
    __device__ explicit Recursion(int p1)
        : penalty(pair_of(static_cast<unsigned>(p1))),
          select_first(lane_index() == 0 ? 0x5454 : 0x5432),
          select_last(lane_index() == lanes - 1 ? 0x3232 : 0x5432) {}

    const Pair penalty;
    const unsigned select_first;
    const unsigned select_last;
};

/// The lesser of the neighbours d - 1 and d + 1 of every slot.
template <int packs>
__device__ void lesser_neighbours(const Recursion& recursion, const PathCosts<packs>& path, Costs<packs>& neighbours) {
    const Pair before = __shfl_up_sync(all_lanes, path.cost[packs - 1], 1);
    const Pair after = __shfl_down_sync(all_lanes, path.cost[0], 1);
    Pair below = __byte_perm(before, path.cost[0], recursion.select_first);
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const Pair above = p + 1 < packs ? __byte_perm(path.cost[p], path.cost[p + 1 < packs ? p + 1 : p], 0x5432)
                                         : __byte_perm(path.cost[p], after, recursion.select_last);
        neighbours[p] = lesser(below, above);
        below = above;
    }
}

/// From the pixel `before` on the line to the pixel with these matching costs; `p2` in both halves. Sums and
/// differences of whole registers: nothing carries or borrows from half to half, because the minimum is taken first and
/// is at least `least` in every slot.
template <int packs>
__device__ PathCosts<packs> continued(const Recursion& recursion, const PathCosts<packs>& before,
                                      const Costs<packs>& costs, Pair p2) {
    const Pair jump = before.least + p2;
    Costs<packs> neighbours;
    lesser_neighbours<packs>(recursion, before, neighbours);
    PathCosts<packs> path;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const Pair step = lesser_of_sum(neighbours[p], recursion.penalty, lesser(before.cost[p], jump));
        path.cost[p] = step - before.least + costs[p];
    }
    find_least<packs>(path);
    return path;
}

struct Pixel {
    int x, y;
};

/// P2' of step 5 in both halves, from pixel to pixel. Outside the image, where a path begins, any does.
template <bool adaptive>
__device__ Pair adapted_p2(const PathsJob& job, Pixel before, Pixel pixel) {
    if constexpr (!adaptive) {
        return pair_of(static_cast<unsigned>(job.p2));
    }
    const auto intensity = [&](Pixel at) {
        return static_cast<int>(
            job.image.at(clamp(at.x, 0, job.image.width - 1), clamp(at.y, 0, job.image.height - 1)));
    };
    const int difference = intensity(pixel) - intensity(before);
    return pair_of(static_cast<unsigned>(max(job.p1 + 1, job.p2 - (difference < 0 ? -difference : difference))));
}

}  // namespace disparityd::cuda
