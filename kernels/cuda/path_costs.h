// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/matching_cost.h"

namespace disparityd::cuda {

/// The path costs L of one pixel of a line, step 5, held by a warp. A path that begins continues one that cost nothing.
template <int packs>
struct PathCosts {
    Costs<packs> cost = {};
    U16x2 least = 0;  ///< in both halves
};

template <int packs>
__device__ void find_min(PathCosts<packs>& path) {
    U16x2 least = path.cost[0];
#pragma unroll
    for (int p = 1; p < packs; ++p) {
        least = min_u16x2(least, path.cost[p]);
    }
    // With the smaller number in both halves the least of the whole words is the least in both halves.
    path.least = min_of_warp(min_u16x2(least, __byte_perm(least, 0, 0x1032)));
}

/// What is the same for all pixels: P1 in both halves, and how a lane takes its neighbours' ends. The first and the
/// last candidate stand for the neighbours that they do not have: with a penalty they are no less than themselves.
class PathPenalties {
public:
    __device__ explicit PathPenalties(int p1)
        : penalty(splat_u16x2(static_cast<unsigned>(p1))),
          select_first(lane_index() == 0 ? 0x5454 : 0x5432),
          select_last(lane_index() == lanes - 1 ? 0x3232 : 0x5432) {}

    const U16x2 penalty;
    const unsigned select_first;
    const unsigned select_last;
};

/// The minimum of the neighbours d - 1 and d + 1 of every slot.
template <int packs>
__device__ void min_neighbours(const PathPenalties& penalties, const PathCosts<packs>& path, Costs<packs>& neighbours) {
    const U16x2 from_lane_below = __shfl_up_sync(all_lanes, path.cost[packs - 1], 1);
    const U16x2 from_lane_above = __shfl_down_sync(all_lanes, path.cost[0], 1);
    U16x2 below = __byte_perm(from_lane_below, path.cost[0], penalties.select_first);
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const U16x2 above = p + 1 < packs ? __byte_perm(path.cost[p], path.cost[p + 1 < packs ? p + 1 : p], 0x5432)
                                          : __byte_perm(path.cost[p], from_lane_above, penalties.select_last);
        neighbours[p] = min_u16x2(below, above);
        below = above;
    }
}

/// From the `previous` pixel on the line to the pixel with these matching costs; `p2` in both halves. Sums and
/// differences of whole registers: nothing carries or borrows from half to half, because the minimum is taken first and
/// is at least `least` in every slot.
template <int packs>
__device__ PathCosts<packs> continued(const PathPenalties& penalties, const PathCosts<packs>& previous,
                                      const Costs<packs>& costs, U16x2 p2) {
    const U16x2 limit = previous.least + p2;
    Costs<packs> neighbours;
    min_neighbours<packs>(penalties, previous, neighbours);
    PathCosts<packs> path;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const U16x2 step = min_u16x2_of_sum(neighbours[p], penalties.penalty, min_u16x2(previous.cost[p], limit));
        path.cost[p] = step - previous.least + costs[p];
    }
    find_min<packs>(path);
    return path;
}

struct Pixel {
    int x, y;
};

/// P2' of step 5 in both halves, from pixel to pixel. Outside the image, where a path begins, any does.
template <bool adaptive>
__device__ U16x2 adapted_p2(const PathsJob& job, Pixel previous, Pixel pixel) {
    if constexpr (!adaptive) {
        return splat_u16x2(static_cast<unsigned>(job.p2));
    }
    const auto intensity = [&](Pixel at) {
        return static_cast<int>(
            job.image.at(clamp(at.x, 0, job.image.width - 1), clamp(at.y, 0, job.image.height - 1)));
    };
    const int difference = intensity(pixel) - intensity(previous);
    const int adapted = job.p2 - job.p2_slope * (difference < 0 ? -difference : difference);
    return splat_u16x2(static_cast<unsigned>(max(max(job.p1 + 1, job.p2_min), adapted)));
}

}  // namespace disparityd::cuda
