// SPDX-License-Identifier: Apache-2.0
// Step 8 of docs/algorithm.md: what the winners of both images do not agree on is rejected.
#if defined(DISPARITYD_CPU_POST_LEFT_RIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_LEFT_RIGHT_INL_H_
#undef DISPARITYD_CPU_POST_LEFT_RIGHT_INL_H_
#else
#define DISPARITYD_CPU_POST_LEFT_RIGHT_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/post/left_right_bytes-inl.h"
#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

class LeftRightCheck {
    using Words = hn::ScalableTag<std::uint16_t>;
    using Numbers = hn::RebindToSigned<Words>;
    using V = hn::Vec<Words>;

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));

    LeftRightCheck(DisparityRange range, int width) : range_(range), width_(width) {}

    /// `width` is at least `lanes`.
    void row(const std::int16_t* left_winner, const std::int16_t* right_winner, std::int16_t* disparity) const {
        for (int begin = 0; begin < width_; begin += at_once) {
            // The last pixels may be checked twice.
            const int count = std::clamp(width_ - begin, lanes, at_once);
            pixels(left_winner, right_winner, std::min(begin, width_ - count), count, disparity);
        }
    }

private:
    static constexpr int at_once = 512;

    // Loads of words one by one, since no instruction set gathers them; some hundred in one go, because what was stored
    // one by one cannot be loaded as a vector right away.
    void pixels(const std::int16_t* left_winner, const std::int16_t* right_winner, int begin, int count,
                std::int16_t* disparity) const {
        std::uint16_t places[at_once];
        std::int16_t right[at_once];
        for (int i = 0; i < count; i += lanes) {
            const int from = std::min(i, count - lanes);
            const V inside = hn::Min(place(left_winner, begin + from), last_x());
            hn::StoreU(inside, Words(), places + from);
        }
        for (int i = 0; i < count; ++i) {
            right[i] = right_winner[places[i]];
        }
        for (int i = 0; i < count; i += lanes) {
            const int from = std::min(i, count - lanes);
            std::int16_t* out = disparity + begin + from;
            const auto agreed = agree(left_winner, begin + from, hn::LoadU(Numbers(), right + from));
            const auto invalid = hn::Set(Numbers(), invalid_disparity(range_));
            hn::StoreU(hn::IfThenElse(agreed, hn::LoadU(Numbers(), out), invalid), Numbers(), out);
        }
    }

    HWY_INLINE V last_x() const { return hn::Set(Words(), static_cast<std::uint16_t>(width_ - 1)); }

    /// The right pixel that the winner leads to; modulo 2^16, so that one left of the image is beyond its right end,
    /// too.
    HWY_INLINE V place(const std::int16_t* left_winner, int x) const {
        const V winner = hn::BitCast(Words(), hn::LoadU(Numbers(), left_winner + x));
        return hn::Sub(numbers_from(Words(), static_cast<std::uint16_t>(x)), winner);
    }

    HWY_INLINE hn::Mask<Numbers> agree(const std::int16_t* left_winner, int x, hn::Vec<Numbers> right) const {
        const auto left = hn::LoadU(Numbers(), left_winner + x);
        const V right_x = place(left_winner, x);
        const V apart = hn::BitCast(Words(), hn::Sub(hn::Max(left, right), hn::Min(left, right)));
        const auto near = hn::Eq(hn::SaturatedSub(apart, hn::Set(Words(), std::uint16_t{1})), hn::Zero(Words()));
        const auto inside = hn::Eq(hn::Min(right_x, last_x()), right_x);
        const auto some = hn::Gt(right, hn::Set(Numbers(), static_cast<std::int16_t>(range_.first - 1)));
        return hn::And(some, hn::RebindMask(Numbers(), hn::And(near, inside)));
    }

    DisparityRange range_;
    int width_;
};

inline void left_right(Plane<const std::int16_t> left_winner, Plane<const std::int16_t> right_winner,
                       DisparityRange range, Plane<std::int16_t> disparity, Rows rows) {
    if (disparity.width < LeftRightCheck::lanes) {
        reference::left_right(left_winner, right_winner, range, disparity, rows);
        return;
    }
    const LeftRightCheck check(range, disparity.width);
#if HWY_TARGET == HWY_AVX3_DL
    LeftRightBytes check_bytes(range, disparity.width);
    const bool in_bytes = LeftRightBytes::fits(range, disparity.width);
#endif
    for (int y = rows.first; y < rows.last; ++y) {
#if HWY_TARGET == HWY_AVX3_DL
        if (in_bytes && check_bytes.row(left_winner.row(y), right_winner.row(y), disparity.row(y))) {
            continue;
        }
#endif
        check.row(left_winner.row(y), right_winner.row(y), disparity.row(y));
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
