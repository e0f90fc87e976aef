// SPDX-License-Identifier: Apache-2.0
// Step 8 of docs/algorithm.md with byte tables: where whole registers can be looked up, the right winners that 64
// pixels can lead to are two or three of them.
#if defined(DISPARITYD_CPU_POST_LEFT_RIGHT_BYTES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_LEFT_RIGHT_BYTES_INL_H_
#undef DISPARITYD_CPU_POST_LEFT_RIGHT_BYTES_INL_H_
#else
#define DISPARITYD_CPU_POST_LEFT_RIGHT_BYTES_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/cpu/simd/wide_tables-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX3_DL
/// Winners are counted from 2 on; 0 is that of a right pixel that has none or is outside, which is near no other.
class LeftRightBytes {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using Bytes = hn::ScalableTag<std::uint8_t>;
    static constexpr int lanes = 64;
    static constexpr int max_table_disparities = 128;

public:
    static bool fits(DisparityRange range, int width) { return range.count <= max_table_disparities && width >= lanes; }

    LeftRightBytes(DisparityRange range, int width) : range_(range), width_(width) {}

    /// False when left winners are not all in the range; then the row is not checked to its end.
    bool row(const std::int16_t* left_winner, const std::int16_t* right_winner, std::int16_t* disparity) {
        for (int begin = 0; begin < width_; begin += lanes) {
            const int x = std::min(begin, width_ - lanes);
            const hn::Vec<Numbers> first = hn::LoadU(Numbers(), right_winner + x);
            const hn::Vec<Numbers> second = hn::LoadU(Numbers(), right_winner + x + lanes / 2);
            hn::StoreU(bytes(right_count(first), right_count(second)), Bytes(), right_ + margin + x);
        }
        bool in_range = true;
        for (int begin = 0; begin < width_ && in_range; begin += lanes) {
            const int x = std::min(begin, width_ - lanes);
            in_range = pixels(left_winner + x, x, disparity + x);
        }
        return in_range;
    }

private:
    static constexpr int margin = 2 * max_disparities + 3 * lanes;  // as far as candidates and tables reach

    static HWY_INLINE hn::Vec<Numbers> number(int value) {
        return hn::Set(Numbers(), static_cast<std::int16_t>(value));
    }
    HWY_INLINE hn::Vec<Numbers> counted(hn::Vec<Numbers> winner) const {
        return hn::SaturatedSub(winner, number(range_.first - 2));
    }
    HWY_INLINE hn::Vec<Numbers> right_count(hn::Vec<Numbers> winner) const {
        return hn::IfThenElseZero(hn::Gt(winner, number(range_.first - 1)), counted(winner));
    }
    static HWY_INLINE hn::Vec<Bytes> bytes(hn::Vec<Numbers> first, hn::Vec<Numbers> second) {
        const hn::Half<Bytes> half;
        return hn::Combine(Bytes(), hn::DemoteTo(half, second), hn::DemoteTo(half, first));
    }

    bool pixels(const std::int16_t* left_winner, int x, std::int16_t* disparity) const {
        const hn::Vec<Numbers> first = counted(hn::LoadU(Numbers(), left_winner));
        const hn::Vec<Numbers> second = counted(hn::LoadU(Numbers(), left_winner + lanes / 2));
        const hn::Vec<Numbers> least = hn::Min(first, second);
        const hn::Vec<Numbers> most = hn::Max(first, second);
        if (!hn::AllFalse(Numbers(), hn::Or(hn::Lt(least, number(2)), hn::Gt(most, number(range_.count + 1))))) {
            return false;
        }
        const hn::Vec<Bytes> left = bytes(first, second);
        const hn::Vec<Bytes> apart = hn::Sub(left, right_of(left, x));
        const hn::Vec<Bytes> one = hn::Set(Bytes(), std::uint8_t{1});
        const hn::Vec<Bytes> two = hn::Set(Bytes(), std::uint8_t{2});
        const auto agree = hn::VecFromMask(Bytes(), hn::Eq(hn::Min(hn::Add(apart, one), two), hn::Add(apart, one)));
        const hn::Half<Bytes> half;
        keep(hn::LowerHalf(half, agree), disparity);
        keep(hn::UpperHalf(half, agree), disparity + lanes / 2);
        return true;
    }

    /// The right pixels' winners; entry 0 of the tables is the pixel that the last candidate of pixel x leads to.
    HWY_INLINE hn::Vec<Bytes> right_of(hn::Vec<Bytes> left, int x) const {
        const std::uint8_t* table = right_ + margin + x - (range_.first + range_.count - 1);
        const hn::Vec<Bytes> index = hn::Sub(numbers_from(Bytes(), static_cast<std::uint8_t>(range_.count + 1)), left);
        const hn::Vec<Bytes> near = look_up(hn::LoadU(Bytes(), table), hn::LoadU(Bytes(), table + lanes), index);
        if (range_.count <= lanes) {
            return near;
        }
        const hn::Vec<Bytes> far = look_up(hn::LoadU(Bytes(), table + 2 * lanes), index);
        return hn::IfThenElse(hn::Gt(index, hn::Set(Bytes(), std::uint8_t{2 * lanes - 1})), far, near);
    }

    HWY_INLINE void keep(hn::Vec<hn::Half<Bytes>> agree, std::int16_t* disparity) const {
        const hn::RebindToSigned<hn::Half<Bytes>> small;
        const auto kept = hn::MaskFromVec(hn::PromoteTo(Numbers(), hn::BitCast(small, agree)));
        const auto found = hn::LoadU(Numbers(), disparity);
        hn::StoreU(hn::IfThenElse(kept, found, number(invalid_disparity(range_))), Numbers(), disparity);
    }

    DisparityRange range_;
    int width_;
    std::uint8_t right_[margin + max_side + margin] = {};
};
#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
