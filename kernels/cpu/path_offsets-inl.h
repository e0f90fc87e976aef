// SPDX-License-Identifier: Apache-2.0
// For P2 <= 63: N(d) = min(L(d) - min L, P2) in one operation. With 255 - P2 - min L added to L, saturation at 255
// takes the minimum; N and M are then 255 - P2 too large ("raised"), M of the paths from the row before P1 less. L = M
// + C is kept as M + C - 130, which fits a byte (0..186, along the row 0..187). What it is too large by goes for min L
// too and is gone at the next pixel.
#if defined(DISPARITYD_CPU_PATH_OFFSETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_PATH_OFFSETS_INL_H_
#undef DISPARITYD_CPU_PATH_OFFSETS_INL_H_
#else
#define DISPARITYD_CPU_PATH_OFFSETS_INL_H_
#endif

#include "kernels/cpu/lanes-inl.h"
#include "kernels/cpu/sgm_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Matching costs of such forms are this much too large, so that adding them to M is all there is to do: -130 in bytes.
/// The least M that occurs, with P1 = 62 and P2 = 63, is 130.
constexpr int raised_cost = 126;
static_assert(raised_cost == 256 - (255 - max_byte_p2 - (max_byte_p2 - 1)));
static_assert(raised_cost + padding_cost < 256);

/// What N and M are too large by.
constexpr std::uint8_t raised_by(std::uint8_t p2) {
    return static_cast<std::uint8_t>(255 - p2);
}

/// What to add at each pixel of a block of a row.
struct PathOffsets {
    alignas(16) std::uint8_t from_before[3][least_block];  ///< to L of the row before; of path 0 for the next pixel
    alignas(16) std::uint8_t along[least_block];           ///< to L - min L along the row
    alignas(16) std::uint8_t surplus[least_block];         ///< what the sum of all four M is too large by

    /// From P2 by position (SweepRow::jumps) and the least costs of the row before, for the pixels from p on.
    /// All M from there together are `less` less than raised.
    HWY_INLINE void take(const PathRow& before, const std::uint8_t* const* jumps, std::uint8_t less, int p) {
        const hn::FixedTag<std::uint8_t, least_block> block;
        const auto top = hn::Set(block, std::uint8_t{255});
        const auto raised = [&](int path, int at) { return hn::Sub(top, hn::LoadU(block, jumps[path] + at)); };
        const auto least = [&](int path, int at) { return hn::LoadU(block, before.least[path] + at); };
        const auto above = raised(1, p);
        const auto above_after = raised(2, p);
        const auto beside = raised(3, p);
        hn::Store(hn::Sub(raised(0, p + 1), least(0, p)), block, from_before[0]);
        hn::Store(hn::Sub(above, least(1, p)), block, from_before[1]);
        hn::Store(hn::Sub(above_after, least(2, p + 1)), block, from_before[2]);
        hn::Store(beside, block, along);
        const auto of_all = hn::Add(hn::Add(raised(0, p), above), hn::Add(above_after, beside));
        hn::Store(hn::Sub(of_all, hn::Set(block, less)), block, surplus);
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
