// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

/// The path costs L of one pixel of a line, step 5, held by a warp.
template <int packs>
struct PathCosts {
    Costs<packs> cost;
    unsigned least;
};

template <int packs>
__device__ void find_least(PathCosts<packs>& path) {
    Pair least = path.cost[0];
#pragma unroll
    for (int p = 1; p < packs; ++p) {
        least = lesser(least, path.cost[p]);
    }
    path.least = least_of_warp(lesser_half(least));
}

template <int packs>
__device__ void begin_path(const Costs<packs>& costs, const Costs<packs>& idle, PathCosts<packs>& path) {
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        path.cost[p] = costs[p] | idle[p];
    }
    find_least(path);
}

/// The lesser of the neighbours d - 1 and d + 1 of every slot. Candidate k - 1 is in the same slot of the lane before,
/// but for lane 0, where it is in the slot before of lane 31; k + 1 likewise.
template <int packs>
__device__ void lesser_neighbours(const PathCosts<packs>& path, Costs<packs>& neighbours) {
    const int lane = lane_index();
    const unsigned select_below = lane == 0 ? 0x5432 : 0x7654;
    const unsigned select_above = lane == lanes - 1 ? 0x5432 : 0x3210;
    Costs<packs> before;
    Costs<packs> after;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        before[p] = __shfl_sync(all_lanes, path.cost[p], (lane + lanes - 1) % lanes);
        after[p] = __shfl_sync(all_lanes, path.cost[p], (lane + 1) % lanes);
    }
    constexpr Pair nothing = unreachable * 0x10001U;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const Pair below = __byte_perm(p == 0 ? nothing : before[p > 0 ? p - 1 : 0], before[p], select_below);
        const Pair above =
            __byte_perm(after[p], p + 1 == packs ? nothing : after[p + 1 < packs ? p + 1 : p], select_above);
        neighbours[p] = lesser(below, above);
    }
}

/// From the pixel before on the line to the pixel with these matching costs. Sums and differences of whole registers:
/// nothing carries or borrows from half to half, because the minimum is taken first and is at least `least` in every
/// slot.
template <int packs>
__device__ void continue_path(const Costs<packs>& costs, const Costs<packs>& idle, int p1, int p2,
                              PathCosts<packs>& path) {
    const Pair penalty = pair_of(static_cast<unsigned>(p1));
    const Pair jump = pair_of(path.least + static_cast<unsigned>(p2));
    const Pair least = pair_of(path.least);
    Costs<packs> neighbours;
    lesser_neighbours(path, neighbours);
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const Pair step = lesser_of_sum(neighbours[p], penalty, lesser(path.cost[p], jump));
        path.cost[p] = (step - least + costs[p]) | idle[p];
    }
    find_least(path);
}

/// P2' of step 5.
__device__ inline int adapted_p2(int p1, int p2, bool adaptive, int intensity, int intensity_before) {
    const int difference = intensity > intensity_before ? intensity - intensity_before : intensity_before - intensity;
    return adaptive ? max(p1 + 1, p2 - difference) : p2;
}

/// Path costs of a pixel in memory, a byte each: two packs are a word of which one has the even bytes, the other the
/// odd ones; of a single pack the two bytes follow each other.
__host__ __device__ constexpr int pixel_bytes(int packs) {
    return 2 * packs * lanes;
}

/// Of one path, all pixels.
template <int packs>
__device__ std::size_t volume_bytes(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
           static_cast<std::size_t>(pixel_bytes(packs));
}

constexpr Pair even_bytes = 0x00ff00ff;

template <int packs>
__device__ void store_path(std::uint8_t* pixel, const PathCosts<packs>& path) {
    const int lane = lane_index();
#pragma unroll
    for (int p = 0; p + 1 < packs; p += 2) {
        reinterpret_cast<std::uint32_t*>(pixel + 2 * p * lanes)[lane] =
            (path.cost[p] & even_bytes) | (path.cost[p + 1] & even_bytes) << 8;
    }
    if constexpr (packs % 2 == 1) {
        reinterpret_cast<std::uint16_t*>(pixel + 2 * (packs - 1) * lanes)[lane] =
            static_cast<std::uint16_t>(__byte_perm(path.cost[packs - 1], 0, 0x4420));
    }
}

template <int packs>
__device__ void add_path(const std::uint8_t* pixel, Costs<packs>& sums) {
    const int lane = lane_index();
#pragma unroll
    for (int p = 0; p + 1 < packs; p += 2) {
        const std::uint32_t word = reinterpret_cast<const std::uint32_t*>(pixel + 2 * p * lanes)[lane];
        sums[p] += word & even_bytes;
        sums[p + 1] += word >> 8 & even_bytes;
    }
    if constexpr (packs % 2 == 1) {
        const unsigned two = reinterpret_cast<const std::uint16_t*>(pixel + 2 * (packs - 1) * lanes)[lane];
        sums[packs - 1] += __byte_perm(two, 0, 0x4140);
    }
}

}  // namespace disparityd::cuda
