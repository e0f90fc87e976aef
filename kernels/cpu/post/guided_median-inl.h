// SPDX-License-Identifier: Apache-2.0
// Step 12 of docs/algorithm.md: median of those samples whose intensity is like the pixel's.
#if defined(DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#undef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#else
#define DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#endif

#include <algorithm>
#include <utility>

#include "kernels/cpu/post/median-inl.h"
#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/selection_network.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Rows of the guide as 16-bit numbers with their ends replicated. Where the disparity is rejected stands an intensity
/// that is like no other, so that one comparison says whether a sample counts.
template <int radius>
class GuideWindow {
public:
    GuideWindow(Plane<const std::uint8_t> guide, Plane<const std::int16_t> disparity, std::int16_t invalid, int first)
        : guide_(guide), disparity_(disparity), invalid_(invalid) {
        for (int y = first - radius; y < first + radius; ++y) {
            load(y);
        }
    }

    void move_to(int y) { load(y + radius); }
    const std::int16_t* row(int y) const { return &rows_[(y + ring) % ring][margin]; }

private:
    static constexpr int margin = 32;
    static constexpr int ring = 8;
    static constexpr std::int16_t like_no_other = 1024;

    void load(int y) {
        const int inside = std::clamp(y, 0, guide_.height - 1);
        const std::uint8_t* guide = guide_.row(inside);
        const std::int16_t* disparity = disparity_.row(inside);
        std::int16_t* out = &rows_[(y + ring) % ring][margin];
        for (int x = 0; x < guide_.width; ++x) {
            out[x] = disparity[x] == invalid_ ? like_no_other : std::int16_t{guide[x]};
        }
        std::fill_n(out - radius, radius, out[0]);
        std::fill_n(out + guide_.width, radius, out[guide_.width - 1]);
    }

    Plane<const std::uint8_t> guide_;
    Plane<const std::int16_t> disparity_;
    std::int16_t invalid_;
    std::int16_t rows_[ring][max_side + 3 * margin] = {};
};

template <std::size_t count, class V, std::size_t... i>
HWY_INLINE V middle_of(V* values, std::index_sequence<i...>) {
    (order(values[exchanges_for_median<count>[i].low], values[exchanges_for_median<count>[i].high]), ...);
    return values[count / 2];
}

/// The median of those that count: the others are the least and the greatest number in turn, the least one first, so
/// that the middle of all is the lower one of two in the middle.
template <int radius>
class GuidedMedian {
public:
    GuidedMedian(const MedianWindow<radius>& disparities, const GuideWindow<radius>& guides)
        : disparities_(disparities), guides_(guides) {}

    /// For the vector of pixels from (x, y) on. What it gives where the pixel itself is rejected is of no use.
    template <class Tag>
    HWY_INLINE hn::Vec<Tag> at(Tag tag, int x, int y) const {
        constexpr int side = 2 * radius + 1;
        using V = hn::Vec<Tag>;
        const V tolerance = hn::Set(tag, static_cast<std::int16_t>(guided_median_tolerance));
        const V guide = hn::LoadU(tag, guides_.row(y) + x);
        V filler = hn::Set(tag, std::int16_t{32767});
        V values[side * side];
        DISPARITYD_UNROLL
        for (int i = 0; i < side; ++i) {
            const std::int16_t* guide_row = guides_.row(y + i - radius) + x - radius;
            const std::int16_t* disparity_row = disparities_.row(y + i - radius) + x - radius;
            DISPARITYD_UNROLL
            for (int j = 0; j < side; ++j) {
                const V difference = hn::Abs(hn::Sub(hn::LoadU(tag, guide_row + j), guide));
                const auto unlike = hn::Gt(difference, tolerance);
                filler = hn::IfThenElse(unlike, hn::Not(filler), filler);
                values[i * side + j] = hn::IfThenElse(unlike, filler, hn::LoadU(tag, disparity_row + j));
            }
        }
        constexpr std::size_t count = side * side;
        return middle_of<count>(values, std::make_index_sequence<exchanges_for_median<count>.size()>());
    }

private:
    const MedianWindow<radius>& disparities_;
    const GuideWindow<radius>& guides_;
};

template <int radius>
void guided_median_rows(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid_value,
                        Plane<std::int16_t> out, Rows rows) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    MedianWindow<radius> disparities(in, rows.first);
    GuideWindow<radius> guides(guide, in, invalid_value, rows.first);
    const GuidedMedian<radius> median(disparities, guides);
    for (int y = rows.first; y < rows.last; ++y) {
        disparities.move_to(y);
        guides.move_to(y);
        for (int x = 0; x < in.width; x += lanes) {
            const auto centre = hn::LoadU(tag, disparities.row(y) + x);
            const auto middle = hn::IfThenElse(hn::Eq(centre, invalid), invalid, median.at(tag, x, y));
            if (x + lanes <= in.width) {
                hn::StoreU(middle, tag, out.row(y) + x);
            } else {
                alignas(64) std::int16_t last[lanes];
                hn::Store(middle, tag, last);
                std::copy_n(last, in.width - x, out.row(y) + x);
            }
        }
    }
}

inline void guided_median(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                          Plane<std::int16_t> out, Rows rows) {
    if (size == 5) {
        guided_median_rows<2>(in, guide, invalid, out, rows);
    } else {
        guided_median_rows<3>(in, guide, invalid, out, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
