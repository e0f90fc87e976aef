// SPDX-License-Identifier: Apache-2.0
// The P2' of step 5 of docs/algorithm.md: SgmKernels::adaptive_p2.
#if defined(DISPARITYD_CPU_SGM_ADAPTIVE_P2_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_ADAPTIVE_P2_INL_H_
#undef DISPARITYD_CPU_SGM_ADAPTIVE_P2_INL_H_
#else
#define DISPARITYD_CPU_SGM_ADAPTIVE_P2_INL_H_
#endif

#include <algorithm>
#include <utility>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/simd/image_rows-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// P2 of each position of a row, for SweepRow::p2_rows.
inline void adaptive_p2(const MatchGeometry& geometry, int direction, const SgmOptions& options,
                        const std::uint8_t* row, const std::uint8_t* previous_row, std::uint8_t* const* p2_rows) {
    const hn::ScalableTag<std::uint8_t> tag;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    const int width = geometry.width;
    // Both rows in the order of the sweep; beyond their ends is no pixel, and no path that could make use of a penalty.
    alignas(64) std::uint8_t here[max_side + 2 * row_slack];
    alignas(64) std::uint8_t previous[max_side + 2 * row_slack];
    for (const auto& [from, to] : {std::pair{row, here}, {previous_row, previous}}) {
        std::fill_n(to, row_slack, std::uint8_t{0});
        std::fill_n(to + row_slack + width, row_slack, std::uint8_t{0});
        if (direction > 0) {
            std::copy_n(from, width, to + row_slack);
        } else {
            mirror(from, width, to + row_slack);
        }
    }
    const auto largest = hn::Set(tag, static_cast<std::uint8_t>(options.p2));
    const auto smallest = hn::Set(tag, static_cast<std::uint8_t>(std::max(options.p1 + 1, options.p2_min)));
    const std::uint8_t* middle = previous + row_slack;
    const std::uint8_t* sources[4] = {middle - 1, middle, middle + 1, here + row_slack - 1};
    for (int path = 0; path < 4; ++path) {
        for (int p = 0; p < width; p += lanes) {
            const auto a = hn::LoadU(tag, here + row_slack + p);
            const auto b = hn::LoadU(tag, sources[path] + p);
            const auto difference = hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
            auto p2 = largest;
            for (int i = 0; i < options.p2_slope; ++i) {  // bytes have no multiplication
                p2 = hn::SaturatedSub(p2, difference);
            }
            hn::StoreU(hn::Max(smallest, p2), tag, p2_rows[path] + p);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
