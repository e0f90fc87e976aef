// SPDX-License-Identifier: Apache-2.0
// Step 13 of docs/algorithm.md as far as it follows from the finished disparity: confidence 0 where it is rejected, the
// chance that another ratio stands for, and depth.
#if defined(DISPARITYD_CPU_POST_OUTPUTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_OUTPUTS_INL_H_
#undef DISPARITYD_CPU_POST_OUTPUTS_INL_H_
#else
#define DISPARITYD_CPU_POST_OUTPUTS_INL_H_
#endif

#include <algorithm>
#include <cstdlib>

#include "hwy/highway.h"
#include "kernels/calibrated_confidence.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The chance that each ratio stands for, calibrated_confidence() for a vector of bytes in words.
class ChanceOfRatio {
    using Words = hn::ScalableTag<std::uint16_t>;
    using Bytes = hn::Repartition<std::uint8_t, Words>;
    using V = hn::Vec<Words>;

public:
    ChanceOfRatio()
        : below_(hn::LoadDup128(Bytes(), chance_at_ratio.data())),
          above_(hn::LoadDup128(Bytes(), chance_at_ratio.data() + 1)) {}

    HWY_INLINE V operator()(V ratio) const {
        const V part = hn::And(ratio, hn::Set(Words(), 15));
        const V index = hn::ShiftRight<4>(ratio);
        // The upper byte of a word looks up something, too; it is cleared.
        const V low_byte = hn::Set(Words(), 255);
        const V below =
            hn::And(hn::BitCast(Words(), hn::TableLookupBytes(below_, hn::BitCast(Bytes(), index))), low_byte);
        const V above =
            hn::And(hn::BitCast(Words(), hn::TableLookupBytes(above_, hn::BitCast(Bytes(), index))), low_byte);
        const V sum = hn::Add(hn::Mul(below, hn::Sub(hn::Set(Words(), 16), part)), hn::Mul(above, part));
        return hn::ShiftRight<4>(hn::Add(sum, hn::Set(Words(), 8)));
    }

private:
    hn::Vec<Bytes> below_;
    hn::Vec<Bytes> above_;
};

inline void finish_confidence(Plane<const std::int16_t> disparity, std::int16_t invalid, bool calibrated,
                              Plane<std::uint8_t> confidence, Rows rows) {
    const hn::ScalableTag<std::int16_t> numbers;
    const hn::RebindToUnsigned<decltype(numbers)> words;
    const hn::Rebind<std::uint8_t, decltype(numbers)> bytes;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(numbers));
    const int width = disparity.width;
    if (width < lanes) {
        reference::finish_confidence(disparity, invalid, calibrated, confidence, rows);
        return;
    }
    const auto rejected = hn::Set(numbers, invalid);
    const ChanceOfRatio chance;
    for (int y = rows.first; y < rows.last; ++y) {
        // The last vector overlaps the one before it: what that has stored must not be calibrated again.
        const auto of_last = hn::LoadU(bytes, confidence.row(y) + width - lanes);
        for (int begin = 0; begin < width; begin += lanes) {
            const int x = std::min(begin, width - lanes);
            std::uint8_t* out = confidence.row(y) + x;
            const auto gone = hn::Eq(hn::LoadU(numbers, disparity.row(y) + x), rejected);
            auto value = hn::PromoteTo(words, x < begin ? of_last : hn::LoadU(bytes, out));
            if (calibrated) {
                value = chance(value);
            }
            value = hn::IfThenZeroElse(hn::RebindMask(words, gone), value);
            hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(numbers, value)), bytes, out);
        }
    }
}

/// The least number that does not fit into 16 bits.
constexpr int beyond_words = 65536;

/// Returns floor(numerator / divisor) where `near` differs from it by one at most, and a number above 65535 where that
/// is above 65535. `near`, numerator and twice the divisor are below 2^31. A product that does not fit wraps; the rest
/// that is computed with it does not.
template <typename V>
HWY_INLINE V corrected_quotient(V near, V numerator, V divisor) {
    const hn::DFromV<V> numbers;
    const V quotient = hn::Min(near, hn::Set(numbers, beyond_words + 1));  // one less is still beyond
    const V rest = hn::Sub(numerator, hn::Mul(quotient, divisor));
    const V one_less = hn::VecFromMask(numbers, hn::Lt(rest, hn::Zero(numbers)));
    const V one_more = hn::VecFromMask(numbers, hn::Gt(rest, hn::Sub(divisor, hn::Set(numbers, 1))));
    return hn::Sub(hn::Add(quotient, one_less), one_more);
}

/// Applies `to_wide`, from 32 to 32 bits, to each half of a vector of 16-bit numbers. Results above 65535 become 65535.
template <typename V, typename F>
HWY_INLINE auto wide_halves(V value, const F& to_wide) {
    const hn::DFromV<V> words;
    const hn::Half<decltype(words)> half;
    const hn::RepartitionToWide<decltype(words)> numbers;
    const hn::RebindToUnsigned<decltype(words)> out;
    const hn::Rebind<std::uint16_t, decltype(numbers)> half_out;
    const auto lower = to_wide(hn::PromoteTo(numbers, hn::LowerHalf(half, value)));
    const auto upper = to_wide(hn::PromoteTo(numbers, hn::UpperHalf(half, value)));
    return hn::Combine(out, hn::DemoteTo(half_out, upper), hn::DemoteTo(half_out, lower));
}

/// Depth from disparity: floor((k + floor(n / 2)) / n) with n = d16 + offset16, divided in single precision.
///
/// `small`: numerators below 2^24 are exact in single precision, and the quotient is too far from the next integer to
/// be rounded up to it. Larger ones give a quotient that is off by one at most where it matters, below 65536, and is
/// put right.
template <bool small>
class DepthOfDisparity {
    using Words = hn::ScalableTag<std::int16_t>;
    using Numbers = hn::RepartitionToWide<Words>;
    using Real = hn::RebindToFloat<Numbers>;
    using V = hn::Vec<Numbers>;

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));

    DepthOfDisparity(std::int16_t invalid, DepthScale scale)
        : invalid_(invalid), k_(static_cast<std::int32_t>(scale.k)), offset16_(scale.offset16) {}

    static bool fits(DepthScale scale) {
        constexpr int max_n = 1 << 16;
        constexpr std::int64_t max_numerator = small ? 1 << 24 : 1 << 30;  // of a camera: some millions
        return scale.k > 0 && scale.k < max_numerator - max_n && std::abs(std::int64_t{scale.offset16}) < max_n / 2;
    }

    void rows(Plane<const std::int16_t> disparity, Plane<std::uint16_t> depth, Rows rows) const {
        for (int y = rows.first; y < rows.last; ++y) {
            for (int begin = 0; begin < disparity.width; begin += lanes) {
                const int x = std::min(begin, disparity.width - lanes);
                pixels(disparity.row(y) + x, depth.row(y) + x);
            }
        }
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), value); }

    HWY_INLINE void pixels(const std::int16_t* disparity, std::uint16_t* depth) const {
        const hn::RebindToUnsigned<Words> out;
        const auto value = hn::LoadU(Words(), disparity);
        const auto all = wide_halves(value, [this](V d16) HWY_ATTR { return millimetres(d16); });
        const auto rejected = hn::VecFromMask(Words(), hn::Eq(value, hn::Set(Words(), invalid_)));
        hn::StoreU(hn::AndNot(hn::BitCast(out, rejected), all), out, depth);
    }

    HWY_INLINE V millimetres(V d16) const {
        const V found = hn::Add(d16, number(offset16_));
        const V n = hn::Max(found, number(1));
        const V numerator = hn::Add(number(k_), hn::ShiftRight<1>(n));
        const V quotient =
            hn::ConvertTo(Numbers(), hn::Div(hn::ConvertTo(Real(), numerator), hn::ConvertTo(Real(), n)));
        const V known = hn::Max(small ? quotient : corrected_quotient(quotient, numerator, n), number(1));
        return hn::IfThenElse(hn::Gt(found, number(0)), known, number(beyond_words - 1));
    }

    std::int16_t invalid_;
    std::int32_t k_;
    std::int32_t offset16_;
};

inline void depth(Plane<const std::int16_t> disparity, std::int16_t invalid, DepthScale scale,
                  Plane<std::uint16_t> depth, Rows rows) {
    using Small = DepthOfDisparity<true>;
    using Large = DepthOfDisparity<false>;
    if (scale.k == 0) {
        for (int y = rows.first; y < rows.last; ++y) {
            std::fill_n(depth.row(y), depth.width, std::uint16_t{0});
        }
    } else if (disparity.width >= Small::lanes && Small::fits(scale)) {
        Small(invalid, scale).rows(disparity, depth, rows);
    } else if (disparity.width >= Large::lanes && Large::fits(scale)) {
        Large(invalid, scale).rows(disparity, depth, rows);
    } else {
        reference::depth(disparity, invalid, scale, depth, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
