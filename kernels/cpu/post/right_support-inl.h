// SPDX-License-Identifier: Apache-2.0
// For step 11 of docs/algorithm.md: which rejected pixels are mismatched, because a winner of the right image supports
// them.
#if defined(DISPARITYD_CPU_POST_RIGHT_SUPPORT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_RIGHT_SUPPORT_INL_H_
#undef DISPARITYD_CPU_POST_RIGHT_SUPPORT_INL_H_
#else
#define DISPARITYD_CPU_POST_RIGHT_SUPPORT_INL_H_
#endif

#include <algorithm>
#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Finds the pixels of a left row that a right pixel supports: its winner, or a candidate beside it, leads to them.
/// Instead of a search from each left pixel, every right pixel marks where it leads.
class RightSupport {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using Bytes = hn::ScalableTag<std::uint8_t>;
    using V = hn::Vec<Numbers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    explicit RightSupport(DisparityRange range) : first_(range.first), last_(range.first + range.count - 1) {}

    void row(const std::int16_t* right_winner, int width) {
        std::fill_n(marks_ + margin - 1, width + 2, std::uint8_t{0});  // of those beyond, none is looked at
        for (int begin = 0; begin < width; begin += at_once) {
            mark(right_winner + begin, begin, std::min(at_once, width - begin));
        }
        spread_marks(width);
    }
    /// Returns the row: not 0 for those that are supported.
    const std::uint8_t* pixels() const { return support_; }

private:
    static constexpr int margin = 2 * max_disparities;  // as far as a candidate can lie outside
    static constexpr int at_once = 128;

    // The marks of a right pixel at the place that its winner leads to.
    static constexpr std::uint8_t here = 1;
    static constexpr std::uint8_t right_of_here = 2;  // the candidate above the winner is in the range, too
    static constexpr std::uint8_t left_of_here = 4;
    static constexpr std::uint8_t all_marks = here | right_of_here | left_of_here;

    void mark(const std::int16_t* right_winner, int x, int count) {
        alignas(64) std::int16_t places[at_once + lanes];
        alignas(64) std::int16_t marked[at_once + lanes];
        alignas(64) std::int16_t last[lanes];
        auto all_or_none = hn::Eq(number(0), number(0));
        for (int i = 0; i < count; i += lanes) {
            const std::int16_t* from = right_winner + i;
            if (i + lanes > count) {
                std::fill_n(last, lanes, std::int16_t{0});
                std::copy_n(from, count - i, last);
                from = last;
            }
            const V winner = hn::LoadU(Numbers(), from);
            const V marks = marks_of(winner);
            const V place = hn::Add(winner, numbers_from(Numbers(), static_cast<std::int16_t>(margin + x + i)));
            const auto none = hn::Eq(marks, number(0));
            all_or_none = hn::And(all_or_none, hn::Or(none, hn::Eq(marks, number(all_marks))));
            hn::Store(hn::IfThenZeroElse(none, place), Numbers(), places + i);
            hn::Store(marks, Numbers(), marked + i);
        }
        // All marks need not be added to what is there.
        if (hn::AllTrue(Numbers(), all_or_none)) {
            DISPARITYD_UNROLL
            for (int i = 0; i < count; ++i) {
                marks_[places[i]] = all_marks;
            }
            return;
        }
        for (int i = 0; i < count; ++i) {
            std::uint8_t& marks = marks_[places[i]];
            marks = static_cast<std::uint8_t>(marks | marked[i]);
        }
    }

    HWY_INLINE V marks_of(V winner) const {
        const V first = number(first_);
        const V last = number(last_);
        const auto in_range = hn::Not(hn::Or(hn::Lt(winner, first), hn::Gt(winner, last)));
        const V above = bits_if(hn::And(in_range, hn::Lt(winner, last)), right_of_here);
        const auto below_in_range = hn::Not(hn::Or(hn::Not(hn::Gt(winner, first)), hn::Gt(winner, number(last_ + 1))));
        return hn::Or(hn::Or(bits_if(in_range, here), above), bits_if(below_in_range, left_of_here));
    }
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), static_cast<std::int16_t>(value)); }
    static HWY_INLINE V bits_if(hn::Mask<Numbers> condition, std::uint8_t bits) {
        return hn::IfThenElseZero(condition, number(bits));
    }

    void spread_marks(int width) {
        const auto part = [](const std::uint8_t* marks, std::uint8_t bits) {
            return hn::And(hn::LoadU(Bytes(), marks), hn::Set(Bytes(), bits));
        };
        for (int x = 0; x < width; x += static_cast<int>(hn::MaxLanes(Bytes()))) {
            const std::uint8_t* marks = marks_ + margin + x;
            const auto beside = hn::Or(part(marks - 1, right_of_here), part(marks + 1, left_of_here));
            hn::Store(hn::Or(part(marks, here), beside), Bytes(), support_ + x);
        }
    }

    int first_;
    int last_;
    std::uint8_t marks_[margin + max_side + margin];
    alignas(64) std::uint8_t support_[max_side];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
