// SPDX-License-Identifier: Apache-2.0
// The smoothed image of step 3 of docs/algorithm.md.
#if defined(DISPARITYD_CPU_COST_SMOOTH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_SMOOTH_INL_H_
#undef DISPARITYD_CPU_COST_SMOOTH_INL_H_
#else
#define DISPARITYD_CPU_COST_SMOOTH_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/reference/steps.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The weighted sum of each pixel of three rows, and of the last pixels once more beyond both ends.
inline void sum_of_rows(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
                        std::uint16_t* sums) {
    const hn::ScalableTag<std::uint16_t> words;
    const hn::Rebind<std::uint8_t, decltype(words)> bytes;
    const int lanes = static_cast<int>(hn::Lanes(words));
    const auto load = [&](const std::uint8_t* from) HWY_ATTR { return hn::PromoteTo(words, hn::LoadU(bytes, from)); };
    for (int i = 0; i < width; i += lanes) {
        const int x = std::min(i, width - lanes);  // the last vector may hold some pixels again
        const auto middle = load(here + x);
        hn::StoreU(hn::Add(hn::Add(load(above + x), load(below + x)), hn::Add(middle, middle)), words, sums + x);
    }
    sums[-1] = sums[0];
    sums[width] = sums[width - 1];
}

inline void smooth(Plane<const std::uint8_t> image, Plane<std::uint8_t> smoothed, Rows rows) {
    const hn::ScalableTag<std::uint16_t> words;
    const hn::Rebind<std::uint8_t, decltype(words)> bytes;
    const int lanes = static_cast<int>(hn::Lanes(words));
    const int width = image.width;
    if (width < lanes) {
        reference::smooth(image, smoothed, rows);
        return;
    }
    constexpr int margin = 32;
    alignas(64) std::uint16_t memory[max_side + 2 * margin];
    std::uint16_t* const sums = memory + margin;
    const auto half = hn::Set(words, std::uint16_t{8});
    for (int y = rows.first; y < rows.last; ++y) {
        sum_of_rows(image.row(std::max(y - 1, 0)), image.row(y), image.row(std::min(y + 1, image.height - 1)), width,
                    sums);
        for (int i = 0; i < width; i += lanes) {
            const int x = std::min(i, width - lanes);
            const auto middle = hn::LoadU(words, sums + x);
            const auto beside = hn::Add(hn::LoadU(words, sums + x - 1), hn::LoadU(words, sums + x + 1));
            const auto sum = hn::Add(hn::Add(beside, hn::Add(middle, middle)), half);
            const hn::RebindToSigned<decltype(words)> numbers;
            hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(numbers, hn::ShiftRight<4>(sum))), bytes, smoothed.row(y) + x);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
