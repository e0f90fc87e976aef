// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

/// What paths add to the matching costs, L - C, at all candidates of all pixels: of one path no more than P2. A byte
/// each, or two where the sum of several paths does not fit one (`wide`; PathsJob).
///
/// A pixel in memory: wide, the packs one after the other, each a word per lane; else two packs share a word, and of a
/// single pack every lane has two bytes.
__host__ __device__ constexpr int pixel_bytes(int packs, bool wide) {
    return (wide ? 4 : 2) * packs * lanes;
}

/// Bytes, of numbers that fit.
template <int packs>
__device__ void store_bytes(std::uint8_t* pixel, const Costs<packs>& costs) {
    const int lane = lane_index();
#pragma unroll
    for (int p = 0; p + 1 < packs; p += 2) {
        reinterpret_cast<std::uint32_t*>(pixel + 2 * p * lanes)[lane] = __byte_perm(costs[p], costs[p + 1], 0x6420);
    }
    if constexpr (packs % 2 == 1) {
        reinterpret_cast<std::uint16_t*>(pixel + 2 * (packs - 1) * lanes)[lane] =
            static_cast<std::uint16_t>(__byte_perm(costs[packs - 1], 0, 0x4420));
    }
}

template <int packs>
__device__ void load_bytes(const std::uint8_t* pixel, Costs<packs>& costs) {
    const int lane = lane_index();
#pragma unroll
    for (int p = 0; p + 1 < packs; p += 2) {
        const std::uint32_t word = reinterpret_cast<const std::uint32_t*>(pixel + 2 * p * lanes)[lane];
        costs[p] = __byte_perm(word, 0, 0x4140);
        costs[p + 1] = __byte_perm(word, 0, 0x4342);
    }
    if constexpr (packs % 2 == 1) {
        const unsigned two = reinterpret_cast<const std::uint16_t*>(pixel + 2 * (packs - 1) * lanes)[lane];
        costs[packs - 1] = __byte_perm(two, 0, 0x4140);
    }
}

template <int packs>
__device__ void store(std::uint8_t* pixel, bool wide, const Costs<packs>& costs) {
    if (!wide) {
        store_bytes<packs>(pixel, costs);
        return;
    }
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        reinterpret_cast<U16x2*>(pixel)[p * lanes + lane_index()] = costs[p];
    }
}

template <int packs>
__device__ void load(const std::uint8_t* pixel, bool wide, Costs<packs>& costs) {
    if (!wide) {
        load_bytes<packs>(pixel, costs);
        return;
    }
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        costs[p] = reinterpret_cast<const U16x2*>(pixel)[p * lanes + lane_index()];
    }
}

}  // namespace disparityd::cuda
