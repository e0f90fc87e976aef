// SPDX-License-Identifier: Apache-2.0
// Step 13 of docs/algorithm.md: depth error from the finished disparity.
#if defined(DISPARITYD_CPU_POST_DEPTH_ERROR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_DEPTH_ERROR_INL_H_
#undef DISPARITYD_CPU_POST_DEPTH_ERROR_INL_H_
#else
#define DISPARITYD_CPU_POST_DEPTH_ERROR_INL_H_
#endif

#include <algorithm>
#include <cstdlib>

#include "hwy/highway.h"
#include "kernels/cpu/post/outputs-inl.h"
#include "kernels/depth_error.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Computes floor((t + floor(n^2 / 2)) / n^2) with n = d16 + offset16, divided in single precision.
///
/// `small`: t is below 2^23 and n at most 2^12, from where on the result is less than 1. Numerator and divisor, at most
/// 2^24, are exact in single precision, and the quotient is too far from the next integer to be rounded up to it.
/// Larger ones give a quotient that is off by one at most where it matters, below 65536, and is put right.
template <bool small>
class ErrorOfDisparity {
    using Words = hn::ScalableTag<std::int16_t>;
    using Numbers = hn::RepartitionToWide<Words>;
    using Real = hn::RebindToFloat<Numbers>;
    using V = hn::Vec<Numbers>;

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));

    explicit ErrorOfDisparity(const DepthErrorScale& scale)
        : numerator_(static_cast<std::int32_t>(scale.numerator)),
          offset16_(static_cast<std::int32_t>(scale.offset16)) {}

    static bool fits(const DepthErrorScale& scale) {
        constexpr std::int64_t max_numerator = small ? 1 << 23 : 1 << 30;  // of a camera: some millions
        return scale.numerator < max_numerator && std::abs(scale.offset16) < 1 << 30;
    }

    void rows(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence, Plane<std::uint16_t> error,
              Rows rows) const {
        for (int y = rows.first; y < rows.last; ++y) {
            for (int begin = 0; begin < disparity.width; begin += lanes) {
                const int x = std::min(begin, disparity.width - lanes);
                pixels(disparity.row(y) + x, confidence.row(y) + x, error.row(y) + x);
            }
        }
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), value); }

    HWY_INLINE void pixels(const std::int16_t* disparity, const std::uint8_t* confidence, std::uint16_t* error) const {
        const hn::RebindToUnsigned<Words> out;
        const hn::Rebind<std::uint8_t, Words> bytes;
        const auto all =
            wide_halves(hn::LoadU(Words(), disparity), [this](V d16) HWY_ATTR { return millimetres(d16); });
        const auto unknown = hn::Eq(hn::PromoteTo(out, hn::LoadU(bytes, confidence)), hn::Zero(out));
        hn::StoreU(hn::IfThenZeroElse(unknown, all), out, error);
    }

    HWY_INLINE V millimetres(V d16) const {
        constexpr int max_n = small ? 1 << 12 : static_cast<int>(max_error_disparity);
        const V found = hn::Add(d16, number(offset16_));
        const V n = hn::Min(hn::Max(found, number(1)), number(max_n));
        const V square = hn::Mul(n, n);
        const V numerator = hn::Add(number(numerator_), hn::ShiftRight<1>(square));
        const V quotient =
            hn::ConvertTo(Numbers(), hn::Div(hn::ConvertTo(Real(), numerator), hn::ConvertTo(Real(), square)));
        const V known = hn::Max(small ? quotient : corrected_quotient(quotient, numerator, square), number(1));
        return hn::IfThenElse(hn::Gt(found, number(0)), known, number(beyond_words - 1));
    }

    std::int32_t numerator_;
    std::int32_t offset16_;
};

inline void depth_error(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence,
                        const DepthErrorScale& scale, Plane<std::uint16_t> error, Rows rows) {
    using Small = ErrorOfDisparity<true>;
    using Large = ErrorOfDisparity<false>;
    if (!scale.known) {
        for (int y = rows.first; y < rows.last; ++y) {
            std::fill_n(error.row(y), error.width, std::uint16_t{0});
        }
    } else if (disparity.width >= Small::lanes && Small::fits(scale)) {
        Small(scale).rows(disparity, confidence, error, rows);
    } else if (disparity.width >= Large::lanes && Large::fits(scale)) {
        Large(scale).rows(disparity, confidence, error, rows);
    } else {
        reference::depth_error(disparity, confidence, scale, error, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
