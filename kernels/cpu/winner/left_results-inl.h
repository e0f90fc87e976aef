// SPDX-License-Identifier: Apache-2.0
// Sub-pixel fit, extrema and confidence (steps 6, 7 and 13 of docs/algorithm.md) from the few sums of each pixel that
// they depend on.
#if defined(DISPARITYD_CPU_WINNER_LEFT_RESULTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_LEFT_RESULTS_INL_H_
#undef DISPARITYD_CPU_WINNER_LEFT_RESULTS_INL_H_
#else
#define DISPARITYD_CPU_WINNER_LEFT_RESULTS_INL_H_
#endif

#include <algorithm>

#include "hwy/highway.h"
#include "kernels/cpu/match_layout.h"
#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/matcher.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// What is known of each pixel of a row, in the words of steps 6 and 7: the winner counted from 0, its sum S0, S- and
/// S+ beside it (at an end of the range the one that exists stands for both), and S2.
struct Minima {
    static constexpr int size = max_side + 32;  // whole vectors
    alignas(64) std::int16_t winner[size];
    alignas(64) std::int16_t least[size];
    alignas(64) std::int16_t minus[size];
    alignas(64) std::int16_t plus[size];
    alignas(64) std::int16_t second[size];
};

/// floor(a / b) for 0 <= a < 2^22, 0 < b < 2^16, in single precision: it is exact there, since the quotient's distance
/// to the next integer, at least 1 / b, is more than rounding can bridge.
template <class V>
HWY_INLINE V divide(V a, V b) {
    const hn::DFromV<V> tag;
    const hn::RebindToFloat<decltype(tag)> real;
    return hn::ConvertTo(tag, hn::Div(hn::ConvertTo(real, a), hn::ConvertTo(real, b)));
}

/// Disparity and confidence from the minima.
class LeftResults {
    using Tag = hn::ScalableTag<std::int32_t>;
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

public:
    LeftResults(const MatchGeometry& geometry, const PostOptions& options)
        : first_(geometry.range.first),
          invalid_(invalid_disparity(geometry.range)),
          subpixel_(options.subpixel),
          extrema_(options.local_extrema),
          uniqueness_(options.uniqueness) {}

    /// As many pixels as there are lanes, from x on; `out` is where the results of pixel x go.
    HWY_INLINE void pixels(const Minima& minima, int x, const WinnerRow& out) const {
        const hn::Rebind<std::int16_t, Tag> words;
        const hn::Rebind<std::uint8_t, Tag> bytes;
        const V least = load(minima.least + x);
        const V minus = load(minima.minus + x);
        const V plus = load(minima.plus + x);
        const V second = load(minima.second + x);
        const V d = hn::Add(load(minima.winner + x), number(first_));
        const auto rejected = hn::Or(flat(least, minus, plus), ambiguous(least, second));
        const V disparity = hn::Add(hn::ShiftLeft<4>(d), offset(least, minus, plus));
        const V sure =
            hn::Add(number(1), divide(hn::Mul(number(254), hn::Sub(second, least)), hn::Max(second, number(1))));
        hn::StoreU(hn::DemoteTo(words, d), words, out.winner);
        hn::StoreU(hn::DemoteTo(words, hn::IfThenElse(hn::MaskFromVec(rejected), number(invalid_), disparity)), words,
                   out.disparity);
        hn::StoreU(hn::DemoteTo(bytes, hn::AndNot(rejected, sure)), bytes, out.confidence);
    }

    void row(const Minima& minima, int width, const WinnerRow& out) const {
        int x = 0;
        for (; x + lanes <= width; x += lanes) {
            pixels(minima, x, {out.winner + x, out.disparity + x, out.confidence + x, nullptr});
        }
        if (x == width) {
            return;
        }
        alignas(64) std::int16_t winner[lanes];
        alignas(64) std::int16_t disparity[lanes];
        alignas(64) std::uint8_t confidence[lanes];
        const int rest = width - x;
        pixels(minima, x, {winner, disparity, confidence, nullptr});
        std::copy_n(winner, rest, out.winner + x);
        std::copy_n(disparity, rest, out.disparity + x);
        std::copy_n(confidence, rest, out.confidence + x);
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Tag(), value); }
    static HWY_INLINE V load(const std::int16_t* from) {
        return hn::PromoteTo(Tag(), hn::LoadU(hn::Rebind<std::int16_t, Tag>(), from));
    }

    // All bits set where the answer is yes.
    HWY_INLINE V flat(V least, V minus, V plus) const {
        const V yes =
            hn::And(hn::VecFromMask(Tag(), hn::Eq(minus, least)), hn::VecFromMask(Tag(), hn::Eq(plus, least)));
        return extrema_ ? yes : number(0);
    }
    HWY_INLINE V ambiguous(V least, V second) const {
        const auto unique = hn::Lt(hn::Mul(least, number(100)), hn::Mul(second, number(100 - uniqueness_)));
        return uniqueness_ > 0 ? hn::Not(hn::VecFromMask(Tag(), unique)) : number(0);
    }

    // Equiangular fit, in 1/16 px.
    HWY_INLINE V offset(V least, V minus, V plus) const {
        if (!subpixel_) {
            return number(0);
        }
        const V steeper = hn::Sub(hn::Max(minus, plus), least);
        const V slope = hn::Sub(minus, plus);
        const V numerator = hn::Add(hn::ShiftLeft<4>(hn::Abs(slope)), steeper);
        const V magnitude = divide(numerator, hn::Max(hn::Add(steeper, steeper), number(1)));
        return hn::IfThenElse(hn::Lt(slope, number(0)), hn::Neg(magnitude), magnitude);
    }

    int first_;
    int invalid_;
    bool subpixel_;
    bool extrema_;
    int uniqueness_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
