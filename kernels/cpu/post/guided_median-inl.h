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

/// The columns that are worked on at a time: their rows stay in the first-level cache, and fit any thread's stack.
constexpr int guided_median_columns = 512;

/// Disparities and intensities of the rows around the row in work, of some columns and those beside them; the borders
/// of the image are replicated. Where a disparity is rejected stands an intensity that is like no other, so that one
/// comparison says whether a sample counts.
template <int radius>
class GuidedSamples {
public:
    GuidedSamples(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> guide, std::int16_t invalid,
                  int first_column, int columns, int first_row)
        : disparity_(disparity), guide_(guide), invalid_(invalid), first_(first_column), columns_(columns) {
        for (int y = first_row - radius; y < first_row + radius; ++y) {
            load(y);
        }
    }

    /// To be called for y = first_row, first_row + 1, ..
    void move_to(int y) { load(y + radius); }

    /// Of the first column.
    const std::int16_t* disparities(int y) const { return &disparities_[(y + ring) % ring][margin]; }
    const std::int16_t* intensities(int y) const { return &intensities_[(y + ring) % ring][margin]; }

private:
    static constexpr int margin = 64;
    static constexpr int ring = 8;
    static constexpr std::int16_t like_no_other = 1024;

    // The columns and `radius` more on both sides.
    template <class T>
    void copy_columns(Plane<const T> from, int y, T* to) const {
        const int begin = std::max(first_ - radius, 0);
        const int end = std::min(first_ + columns_ + radius, from.width);
        const T* row = from.row(std::clamp(y, 0, from.height - 1));
        std::copy(row + begin, row + end, to + (begin - first_));
        std::fill(to - radius, to + (begin - first_), row[0]);
        std::fill(to + (end - first_), to + columns_ + radius, row[from.width - 1]);
    }

    void load(int y) {
        const hn::ScalableTag<std::int16_t> tag;
        const hn::Rebind<std::uint8_t, decltype(tag)> bytes;
        const int lanes = static_cast<int>(hn::Lanes(tag));
        std::int16_t* disparity = &disparities_[(y + ring) % ring][margin];
        std::int16_t* out = &intensities_[(y + ring) % ring][margin];
        std::uint8_t* guide = &guide_row_[margin];
        copy_columns(disparity_, y, disparity);
        copy_columns(guide_, y, guide);
        const auto invalid = hn::Set(tag, invalid_);
        const auto rejected = hn::Set(tag, like_no_other);
        for (int x = -radius; x < columns_ + radius; x += lanes) {
            const auto intensity = hn::PromoteTo(tag, hn::LoadU(bytes, guide + x));
            const auto is_rejected = hn::Eq(hn::LoadU(tag, disparity + x), invalid);
            hn::StoreU(hn::IfThenElse(is_rejected, rejected, intensity), tag, out + x);
        }
    }

    Plane<const std::int16_t> disparity_;
    Plane<const std::uint8_t> guide_;
    std::int16_t invalid_;
    int first_;
    int columns_;
    std::uint8_t guide_row_[guided_median_columns + 2 * margin] = {};
    std::int16_t disparities_[ring][guided_median_columns + 2 * margin] = {};
    std::int16_t intensities_[ring][guided_median_columns + 2 * margin] = {};
};

template <std::size_t count, class V, std::size_t... i>
HWY_INLINE V middle_of(V* values, std::index_sequence<i...>) {
    (order(values[exchanges_for_median<count>[i].low], values[exchanges_for_median<count>[i].high]), ...);
    return values[count / 2];
}

/// The median of those that count, for the vector of pixels from column x of the samples on: the others are the least
/// and the greatest number in turn, the least one first, so that the middle of all is the lower one of two in the
/// middle. What it gives where the pixel itself is rejected is of no use.
template <int radius, class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V guided_median_at(Tag tag, const GuidedSamples<radius>& samples, int x, int y) {
    constexpr int side = 2 * radius + 1;
    const V tolerance = hn::Set(tag, static_cast<std::int16_t>(guided_median_tolerance));
    const V intensity = hn::LoadU(tag, samples.intensities(y) + x);
    V filler = hn::Set(tag, std::int16_t{32767});
    V values[side * side];
    DISPARITYD_UNROLL
    for (int i = 0; i < side; ++i) {
        const std::int16_t* intensities = samples.intensities(y + i - radius) + x - radius;
        const std::int16_t* disparities = samples.disparities(y + i - radius) + x - radius;
        DISPARITYD_UNROLL
        for (int j = 0; j < side; ++j) {
            const V difference = hn::Abs(hn::Sub(hn::LoadU(tag, intensities + j), intensity));
            const auto unlike = hn::Gt(difference, tolerance);
            filler = hn::IfThenElse(unlike, hn::Not(filler), filler);
            values[i * side + j] = hn::IfThenElse(unlike, filler, hn::LoadU(tag, disparities + j));
        }
    }
    constexpr std::size_t count = side * side;
    return middle_of<count>(values, std::make_index_sequence<exchanges_for_median<count>.size()>());
}

template <int radius>
void guided_median_of_columns(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid_value,
                              int first, int columns, Plane<std::int16_t> out, Rows rows) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    GuidedSamples<radius> samples(in, guide, invalid_value, first, columns, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        samples.move_to(y);
        std::int16_t* to = out.row(y) + first;
        for (int x = 0; x < columns; x += lanes) {
            const auto is_rejected = hn::Eq(hn::LoadU(tag, samples.disparities(y) + x), invalid);
            const auto middle = hn::IfThenElse(is_rejected, invalid, guided_median_at(tag, samples, x, y));
            if (x + lanes <= columns) {
                hn::StoreU(middle, tag, to + x);
            } else {
                alignas(64) std::int16_t last[lanes];
                hn::Store(middle, tag, last);
                std::copy_n(last, columns - x, to + x);
            }
        }
    }
}

inline void guided_median(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                          Plane<std::int16_t> out, Rows rows) {
    for (int first = 0; first < in.width; first += guided_median_columns) {
        const int columns = std::min(guided_median_columns, in.width - first);
        if (size == 5) {
            guided_median_of_columns<2>(in, guide, invalid, first, columns, out, rows);
        } else {
            guided_median_of_columns<3>(in, guide, invalid, first, columns, out, rows);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
