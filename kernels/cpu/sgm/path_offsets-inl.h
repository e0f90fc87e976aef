// SPDX-License-Identifier: Apache-2.0
// For P2 <= 63: N(d) = min(L(d) - min L, P2) in one operation. With 255 - P2 - min L added to L, saturation at 255
// takes the minimum. N and M then have a bias of 255 - P2, less P1 in M of the paths from the previous row. L = M + C
// is kept as M + C - 130, which fits a byte (0..186, along the row 0..187). Min L has the same bias as L, so the
// difference at the next pixel has none.
#if defined(DISPARITYD_CPU_SGM_PATH_OFFSETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_PATH_OFFSETS_INL_H_
#undef DISPARITYD_CPU_SGM_PATH_OFFSETS_INL_H_
#else
#define DISPARITYD_CPU_SGM_PATH_OFFSETS_INL_H_
#endif

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The bias of the matching costs of such variants: adding such a cost to M is all there is to do. It is -130 in bytes.
/// The least M that occurs, with P1 = 62 and P2 = 63, is 130.
constexpr int cost_bias = 126;
static_assert(cost_bias == 256 - (255 - max_byte_p2 - (max_byte_p2 - 1)));
static_assert(cost_bias + padding_cost < 256);

/// The bias of N and M.
constexpr std::uint8_t bias_for(std::uint8_t p2) {
    return static_cast<std::uint8_t>(255 - p2);
}

/// What to add at each pixel of a block of a row.
struct PathOffsets {
    alignas(16) std::uint8_t from_previous_row[3][min_block];  ///< to L there; of path 0 for the next pixel
    alignas(16) std::uint8_t along[min_block];                 ///< to L - min L along the row
    alignas(16) std::uint8_t sum_bias[min_block];              ///< the bias of the sum of all M

    /// From P2 by position (SweepRow::p2_rows) and the least costs of the previous row, for the pixels from p on.
    /// `less` is missing in the bias of all M from there together. Without diagonals there is path 1 alone.
    template <bool diagonals>
    HWY_INLINE void take(const PathRow& previous_row, const std::uint8_t* const* p2_rows, std::uint8_t less, int p) {
        const hn::FixedTag<std::uint8_t, min_block> block;
        const auto top = hn::Set(block, std::uint8_t{255});
        const auto bias = [&](int path, int at) { return hn::Sub(top, hn::LoadU(block, p2_rows[path] + at)); };
        const auto least = [&](int path, int at) { return hn::LoadU(block, previous_row.least[path] + at); };
        const auto above = bias(1, p);
        const auto beside = bias(3, p);
        hn::Store(hn::Sub(above, least(1, p)), block, from_previous_row[1]);
        hn::Store(beside, block, along);
        auto of_all = hn::Add(above, beside);
        if constexpr (diagonals) {
            const auto above_after = bias(2, p);
            hn::Store(hn::Sub(bias(0, p + 1), least(0, p)), block, from_previous_row[0]);
            hn::Store(hn::Sub(above_after, least(2, p + 1)), block, from_previous_row[2]);
            of_all = hn::Add(of_all, hn::Add(bias(0, p), above_after));
        }
        hn::Store(hn::Sub(of_all, hn::Set(block, less)), block, sum_bias);
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
