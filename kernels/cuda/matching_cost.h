// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

template <Cost cost>
using WordOf = std::conditional_t<cost == Cost::census_9x7, std::uint64_t, GradientWord>;

/// What a candidate outside the image costs.
template <Cost cost>
constexpr unsigned cost_outside = cost == Cost::census_9x7 ? 62 : 18;

template <Cost cost>
__device__ const WordOf<cost>* words_of(const std::uint64_t* plane) {
    return reinterpret_cast<const WordOf<cost>*>(plane);
}

/// Step 4, census-9x7, for a pixel with this word; right(slot) is its candidate's. Candidates outside the image are to
/// be limited.
template <int packs, typename Right>
__device__ void census_costs(std::uint64_t word, Right right, Costs<packs>& costs) {
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const auto low = static_cast<unsigned>(__popcll(word ^ right(2 * p)));
        costs[p] = low + (static_cast<unsigned>(__popcll(word ^ right(2 * p + 1))) << 16);
    }
}

constexpr unsigned max_gradient_cost = 12;

/// The same, census-7x5+gradient.
template <int packs, typename Right>
__device__ void census_costs(const GradientWord& word, Right right, Costs<packs>& costs) {
    constexpr int rows = 3;
#pragma unroll
    for (int p = 0; p < packs; ++p) {
        const GradientWord low = right(2 * p);
        const GradientWord high = right(2 * p + 1);
        const unsigned low_differences = __vabsdiffu4(word.gradients, low.gradients);
        const unsigned high_differences = __vabsdiffu4(word.gradients, high.gradients);
        U16x2 of_row[rows];
#pragma unroll
        for (int row = 0; row < rows; ++row) {
            const auto bits_low = static_cast<unsigned>(__popc(word.census[row] ^ low.census[row]));
            const auto bits_high = static_cast<unsigned>(__popc(word.census[row] ^ high.census[row]));
            // The byte of the row from each, with the highest one, which is 0, above it.
            const U16x2 gradient =
                __byte_perm(low_differences, high_differences, 0x7430U + 0x0101U * static_cast<unsigned>(row));
            of_row[row] = bits_low + (bits_high << 16) + min_u16x2(gradient, splat_u16x2(max_gradient_cost));
        }
        costs[p] = average_u16x2(average_u16x2(of_row[0], of_row[2]), of_row[1]);
    }
}

/// The right words of the candidates of the pixel that a walk along a row has come to: from pixel to pixel one is new
/// in each lane.
template <Cost cost, int packs, int dx>
class WordsAlongRow {
public:
    /// Before the pixel `x`, which has phase 0.
    __device__ WordsAlongRow(const WordOf<cost>* __restrict__ row, const CandidateBounds<packs>& bounds, int x)
        : row_(row), bounds_(bounds) {
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            words_[renamed<packs, dx>(s, slots - 1)] = row[bounds.column(x - dx, s)];
        }
    }

    /// Step 4 for the next pixel, which is at x.
    __device__ void next(WordOf<cost> left, int x, int phase, Costs<packs>& costs) {
        constexpr int entering = dx > 0 ? 0 : slots - 1;
        words_[renamed<packs, dx>(entering, phase)] = row_[bounds_.column(x, entering)];
        census_costs<packs>(
            left, [&](int slot) { return words_[renamed<packs, dx>(slot, phase)]; }, costs);
        if (!bounds_.all_inside(x)) {
            bounds_.limit(x, cost_outside<cost>, costs);
        }
    }

private:
    static constexpr int slots = slots_of(packs);

    const WordOf<cost>* __restrict__ row_;
    const CandidateBounds<packs>& bounds_;
    WordOf<cost> words_[slots];
};

/// Calls step(std::integral_constant) with the cost.
template <typename Step>
void with_cost(Cost cost, Step step) {
    if (cost == Cost::census_9x7) {
        step(std::integral_constant<Cost, Cost::census_9x7>());
    } else {
        step(std::integral_constant<Cost, Cost::census_7x5_gradient>());
    }
}

/// Calls step(cost, packs, adaptive) with what the job's kernels are made for: the cost, the packs that its candidates
/// need, and whether P2 adapts.
template <typename Step>
void with_variant(const PathsJob& job, Step step) {
    with_cost(job.cost, [&](auto cost) {
        with_packs(job.range.count, [&](auto packs) {
            if (job.adaptive_p2) {
                step(cost, packs, std::true_type());
            } else {
                step(cost, packs, std::false_type());
            }
        });
    });
}

}  // namespace disparityd::cuda
