// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "kernels/cuda/packed.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

/// How a warp holds the candidates of a pixel: candidate k (d = first + k) is in lane k % 32, and there in slot k / 32.
/// Two slots are a Pair: slots 2p and 2p + 1 the low and high half of pack p. So neighbouring lanes read neighbouring
/// words of the right image. Slots from `count` on are idle: never less than `unreachable`.
template <int packs>
using Costs = Pair[packs];

__host__ __device__ constexpr int slots_of(int packs) {
    return 2 * packs;
}

/// The packs that hold so many candidates; 1 to 4.
__host__ __device__ constexpr int packs_for(int count) {
    return (count + 2 * lanes - 1) / (2 * lanes);
}

__device__ inline int lane_index() {
    return static_cast<int>(threadIdx.x);
}

/// Which slots are idle, as bits that make a cost unreachable.
template <int packs>
__device__ void idle_slots(int count, Costs<packs>& idle) {
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const int k = 2 * p * lanes + lane_index();
        idle[p] = (k < count ? 0 : unreachable) | (k + lanes < count ? 0 : unreachable << 16);
    }
}

/// Step 4 for the pixel at x, whose place in the right image's words is `right`: there candidate k lies first + k to
/// the left.
template <int packs>
__device__ void census_costs(std::uint64_t word, const std::uint64_t* __restrict__ right, int width, int x, int first,
                             Costs<packs>& costs) {
    constexpr unsigned outside = 62;
    const int nearest = x - first - lane_index();
    const std::uint64_t* __restrict__ words = right - first - lane_index();
    unsigned slots[slots_of(packs)];
#pragma unroll
    for (int s = 0; s < slots_of(packs); ++s) {
        const bool inside = static_cast<unsigned>(nearest - s * lanes) < static_cast<unsigned>(width);
        slots[s] = inside ? static_cast<unsigned>(__popcll(word ^ words[-s * lanes])) : outside;
    }
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        costs[p] = slots[2 * p] | slots[2 * p + 1] << 16;
    }
}

/// Calls step(std::integral_constant) with the packs that `count` candidates need.
template <typename Step>
void with_packs(int count, Step step) {
    switch (packs_for(count)) {
        case 1: step(std::integral_constant<int, 1>()); break;
        case 2: step(std::integral_constant<int, 2>()); break;
        case 3: step(std::integral_constant<int, 3>()); break;
        default: step(std::integral_constant<int, 4>()); break;
    }
}

}  // namespace disparityd::cuda
