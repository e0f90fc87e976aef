// SPDX-License-Identifier: Apache-2.0
// Step 12 of docs/algorithm.md as far as it follows from the finished disparity: confidence 0 where it is rejected, and
// depth.
#if defined(DISPARITYD_CPU_OUTPUTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_OUTPUTS_INL_H_
#undef DISPARITYD_CPU_OUTPUTS_INL_H_
#else
#define DISPARITYD_CPU_OUTPUTS_INL_H_
#endif

#include <algorithm>
#include <cstdlib>

#include "hwy/highway.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline void mask_confidence(Plane<const std::int16_t> disparity, std::int16_t invalid, Plane<std::uint8_t> confidence,
                            Rows rows) {
    const hn::ScalableTag<std::int16_t> numbers;
    const hn::Rebind<std::int8_t, decltype(numbers)> small;
    const hn::Rebind<std::uint8_t, decltype(numbers)> bytes;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(numbers));
    const int width = disparity.width;
    if (width < lanes) {
        reference::mask_confidence(disparity, invalid, confidence, rows);
        return;
    }
    const auto rejected = hn::Set(numbers, invalid);
    for (int y = rows.first; y < rows.last; ++y) {
        for (int begin = 0; begin < width; begin += lanes) {
            const int x = std::min(begin, width - lanes);
            const auto is_rejected = hn::Eq(hn::LoadU(numbers, disparity.row(y) + x), rejected);
            const auto gone = hn::BitCast(bytes, hn::DemoteTo(small, hn::VecFromMask(numbers, is_rejected)));
            std::uint8_t* out = confidence.row(y) + x;
            hn::StoreU(hn::AndNot(gone, hn::LoadU(bytes, out)), bytes, out);
        }
    }
}

/// floor((k + floor(n / 2)) / n) of the pixels' n = d16 + offset16, in single precision and then put right: the
/// quotient is off by one at most where it matters, below 65536.
class DepthOfDisparity {
    using Words = hn::ScalableTag<std::int16_t>;
    using Numbers = hn::RepartitionToWide<Words>;
    using Real = hn::RebindToFloat<Numbers>;
    using V = hn::Vec<Numbers>;
    static constexpr int most = 65535;
    static constexpr int beyond = most + 2;  // still more than `most` when it is one too large

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));

    /// Whether numerators and products stay within 32 bits: of a camera, k is a millionth of what is allowed.
    static bool fits(DepthScale scale) {
        return scale.k > 0 && scale.k < (1 << 30) && std::abs(static_cast<std::int64_t>(scale.offset16)) < (1 << 13);
    }

    DepthOfDisparity(std::int16_t invalid, DepthScale scale)
        : invalid_(invalid), k_(static_cast<std::int32_t>(scale.k)), offset16_(scale.offset16) {}

    /// As many pixels as there are lanes.
    HWY_INLINE void pixels(const std::int16_t* disparity, std::uint16_t* depth) const {
        const hn::RebindToUnsigned<Words> out;
        const hn::Half<Words> half;
        const auto value = hn::LoadU(Words(), disparity);
        const V lower = millimetres(hn::PromoteTo(Numbers(), hn::LowerHalf(half, value)));
        const V upper = millimetres(hn::PromoteTo(Numbers(), hn::UpperHalf(half, value)));
        const hn::Rebind<std::uint16_t, Numbers> half_out;
        const auto all = hn::Combine(out, hn::DemoteTo(half_out, upper), hn::DemoteTo(half_out, lower));
        const auto rejected = hn::VecFromMask(Words(), hn::Eq(value, hn::Set(Words(), invalid_)));
        hn::StoreU(hn::AndNot(hn::BitCast(out, rejected), all), out, depth);
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), value); }

    HWY_INLINE V millimetres(V d16) const {
        const V found = hn::Add(d16, number(offset16_));
        const V n = hn::Max(found, number(1));
        const V numerator = hn::Add(number(k_), hn::ShiftRight<1>(n));
        const V near = hn::ConvertTo(Numbers(), hn::Div(hn::ConvertTo(Real(), numerator), hn::ConvertTo(Real(), n)));
        const V quotient = hn::Min(near, number(beyond));
        const V rest = hn::Sub(numerator, hn::Mul(quotient, n));
        const V one_less = hn::VecFromMask(Numbers(), hn::Lt(rest, number(0)));
        const V one_more = hn::VecFromMask(Numbers(), hn::Gt(rest, hn::Sub(n, number(1))));
        const V exact = hn::Sub(hn::Add(quotient, one_less), one_more);
        const V known = hn::Min(hn::Max(exact, number(1)), number(most));
        return hn::IfThenElse(hn::Gt(found, number(0)), known, number(most));
    }

    std::int16_t invalid_;
    std::int32_t k_;
    std::int32_t offset16_;
};

inline void depth(Plane<const std::int16_t> disparity, std::int16_t invalid, DepthScale scale,
                  Plane<std::uint16_t> depth, Rows rows) {
    const int width = disparity.width;
    if (width < DepthOfDisparity::lanes || !DepthOfDisparity::fits(scale)) {
        reference::depth(disparity, invalid, scale, depth, rows);
        return;
    }
    const DepthOfDisparity depth_of(invalid, scale);
    for (int y = rows.first; y < rows.last; ++y) {
        for (int begin = 0; begin < width; begin += depth_of.lanes) {
            const int x = std::min(begin, width - depth_of.lanes);
            depth_of.pixels(disparity.row(y) + x, depth.row(y) + x);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
