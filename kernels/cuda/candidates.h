// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "kernels/cuda/packed.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

/// How a warp holds the candidates of a pixel: each lane has so many slots, and candidate k (d = first + k) is in lane
/// k / slots, slot k % slots. Two slots are a U16x2: slots 2p and 2p + 1 the low and high half of pack p. So d - 1 and
/// d + 1 are in the same lane but at its ends. Slots from `count` on are idle: never less than `unreachable`.
template <int packs>
using Costs = U16x2[packs];

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

/// The number of a warp in its block.
__device__ inline int warp_index() {
    return same_in_warp(static_cast<int>(threadIdx.y));
}

template <int packs>
__device__ int candidate(int slot) {
    return slots_of(packs) * lane_index() + slot;
}

/// Which slots have a candidate whose right pixel lies inside the image.
template <int packs>
class CandidateBounds {
public:
    /// Of `columns` neighbouring pixels, which all_inside() asks about at once.
    __device__ CandidateBounds(Range range, int width, int columns = 1) : range_(range), width_(width) {
        constexpr int all = slots_of(packs) * lanes;
        from_ = range.first + all - 1;
        all_inside_ = range.count == all ? static_cast<unsigned>(max(width - all + 2 - columns, 0)) : 0;
    }

    /// Whether all slots have, for the pixel at x and its columns - 1 neighbours to the right: most pixels of an image.
    __device__ bool all_inside(int x) const { return static_cast<unsigned>(x - from_) < all_inside_; }

    /// Gives candidates outside the image that cost, idle slots one that none can reach.
    __device__ void limit(int x, unsigned outside, Costs<packs>& costs) const {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            const unsigned low = limited(x, 2 * p, outside, costs[p] & 0xffff);
            costs[p] = low | limited(x, 2 * p + 1, outside, costs[p] >> 16) << 16;
        }
    }

    __device__ void limit_idle(Costs<packs>& costs) const {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            costs[p] |= (candidate<packs>(2 * p) < range_.count ? 0 : unreachable) |
                        (candidate<packs>(2 * p + 1) < range_.count ? 0 : unreachable << 16);
        }
    }

    /// The column of the right image that a lane's first candidate leads to; one close to the image, of which it has no
    /// other candidate either, where it is far outside.
    __device__ int first_column(int x) const {
        return clamp(x - range_.first - candidate<packs>(0), 0, width_ + margin_words);
    }

    /// The column of the right image that the candidate leads to, or the nearest one there is.
    __device__ int column(int x, int slot) const {
        return clamp(x - range_.first - candidate<packs>(slot), 0, width_ - 1);
    }

private:
    __device__ unsigned limited(int x, int slot, unsigned outside, unsigned cost) const {
        const int k = candidate<packs>(slot);
        const bool inside = static_cast<unsigned>(x - range_.first - k) < static_cast<unsigned>(width_);
        return k >= range_.count ? unreachable : inside ? cost : outside;
    }

    Range range_;
    int width_;
    int from_;
    unsigned all_inside_;
};

/// A register for each slot of a warp that walks along a row, from left to right (dx = 1) or from right to left (-1).
/// From pixel to pixel everything moves by a slot, which is done by other names: `phase` counts the pixels modulo
/// slots, and has to be known to the compiler.
template <int packs, int dx>
__device__ constexpr int renamed(int slot, int phase) {
    constexpr int slots = slots_of(packs);
    return (slot + slots - dx * phase) % slots;
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
