// SPDX-License-Identifier: Apache-2.0
// Step 8 of docs/algorithm.md: what the winners of both images do not agree on is rejected.
#if defined(DISPARITYD_CPU_LEFT_RIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_LEFT_RIGHT_INL_H_
#undef DISPARITYD_CPU_LEFT_RIGHT_INL_H_
#else
#define DISPARITYD_CPU_LEFT_RIGHT_INL_H_
#endif

#include <algorithm>

#include "hwy/highway.h"
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

    /// As many pixels as there are lanes, from x on.
    HWY_INLINE void pixels(const std::int16_t* left_winner, const std::int16_t* right_winner, int x,
                           std::int16_t* disparity) const {
        const auto left = hn::LoadU(Numbers(), left_winner + x);
        // Modulo 2^16, so that what lies left of the image is beyond its right end, too.
        const V right_x = hn::Sub(hn::Iota(Words(), static_cast<std::uint16_t>(x)), hn::BitCast(Words(), left));
        const V last_x = hn::Set(Words(), static_cast<std::uint16_t>(width_ - 1));
        const V inside_x = hn::Min(right_x, last_x);
        const auto right = at(right_winner, inside_x);
        const V apart = hn::BitCast(Words(), hn::Sub(hn::Max(left, right), hn::Min(left, right)));
        const auto near = hn::Eq(hn::SaturatedSub(apart, hn::Set(Words(), std::uint16_t{1})), hn::Zero(Words()));
        const auto some = hn::Gt(right, hn::Set(Numbers(), static_cast<std::int16_t>(range_.first - 1)));
        const auto inside = hn::Eq(right_x, inside_x);
        const auto agree = hn::And(some, hn::RebindMask(Numbers(), hn::And(near, inside)));
        const auto found = hn::LoadU(Numbers(), disparity + x);
        hn::StoreU(hn::IfThenElse(agree, found, hn::Set(Numbers(), invalid_disparity(range_))), Numbers(),
                   disparity + x);
    }

private:
    // Loads of words one by one: no instruction set gathers them.
    static HWY_INLINE hn::Vec<Numbers> at(const std::int16_t* row, V index) {
        alignas(64) std::uint16_t from[lanes];
        alignas(64) std::int16_t found[lanes];
        hn::Store(index, Words(), from);
        for (int i = 0; i < lanes; ++i) {
            found[i] = row[from[i]];
        }
        return hn::Load(Numbers(), found);
    }

    DisparityRange range_;
    int width_;
};

inline void left_right(Plane<const std::int16_t> left_winner, Plane<const std::int16_t> right_winner,
                       DisparityRange range, Plane<std::int16_t> disparity, Rows rows) {
    const int width = disparity.width;
    const LeftRightCheck check(range, width);
    if (width < check.lanes) {
        reference::left_right(left_winner, right_winner, range, disparity, rows);
        return;
    }
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < width; x += check.lanes) {
            // The last pixels may be checked twice.
            check.pixels(left_winner.row(y), right_winner.row(y), std::min(x, width - check.lanes), disparity.row(y));
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
