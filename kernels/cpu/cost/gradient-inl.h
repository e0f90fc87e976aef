// SPDX-License-Identifier: Apache-2.0
// The gradient byte of step 3 of docs/algorithm.md, and its part of the costs of step 4.
#if defined(DISPARITYD_CPU_COST_GRADIENT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_GRADIENT_INL_H_
#undef DISPARITYD_CPU_COST_GRADIENT_INL_H_
#else
#define DISPARITYD_CPU_COST_GRADIENT_INL_H_
#endif

#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The gradients of a vector of bytes from position x on. `rows` points to the row of the window that is in work, the
/// ones above and below stand beside it; `right` is the step to the right in the image, -1 where rows are mirrored.
/// `shift`: by how many bits they are shifted.
template <int shift>
void store_gradients(const std::int8_t* const* rows, int x, int right, std::uint8_t* out) {
    const hn::ScalableTag<std::int16_t> words;
    const hn::Rebind<std::int8_t, decltype(words)> half;
    const hn::Rebind<std::uint8_t, decltype(words)> unsigned_half;
    const int lanes = static_cast<int>(hn::Lanes(words));
    const auto most = hn::Set(words, std::int16_t{16 << shift});
    for (int i = 0; i < 2 * lanes; i += lanes) {
        const auto difference = [&](int dy) HWY_ATTR {
            const std::int8_t* at = rows[dy] + x + i;
            return hn::Sub(hn::PromoteTo(words, hn::LoadU(half, at + right)),
                           hn::PromoteTo(words, hn::LoadU(half, at - right)));
        };
        const auto middle = difference(0);
        const auto sobel = hn::Add(hn::Add(difference(-1), difference(1)), hn::Add(middle, middle));
        const auto clamped = hn::Min(hn::Max(sobel, hn::Neg(most)), most);
        const auto gradient = hn::Add(hn::ShiftRight<shift>(clamped), hn::Set(words, std::int16_t{128}));
        hn::StoreU(hn::DemoteTo(unsigned_half, gradient), unsigned_half, out + i);
    }
}

/// min(|a - b|, 12), which the gradients of two pixels add to their cost.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V gradient_cost(Tag tag, V a, V b) {
    constexpr std::uint8_t most = 12;
    return hn::Min(absolute_difference(a, b), hn::Set(tag, most));
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
