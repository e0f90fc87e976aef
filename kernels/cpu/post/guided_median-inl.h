// SPDX-License-Identifier: Apache-2.0
// Step 12 of docs/algorithm.md: median of those samples whose intensity is like the pixel's.
#if defined(DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#undef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#else
#define DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/post/exchange_order.h"
#include "kernels/cpu/post/median-inl.h"
#include "kernels/cpu/simd/lanes-inl.h"
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

/// Where the samples of a vector of pixels begin, row by row.
template <int radius>
struct SampleRows {
    static constexpr int side = 2 * radius + 1;
    const std::int16_t* disparities[side];
    const std::int16_t* intensities[side];

    SampleRows(const GuidedSamples<radius>& samples, int y) {
        for (int i = 0; i < side; ++i) {
            disparities[i] = samples.disparities(y + i - radius) - radius;
            intensities[i] = samples.intensities(y + i - radius) - radius;
        }
    }
};

/// The median of those samples that count, for the vector of pixels from column x on: the others are the least and the
/// greatest number in turn, the least one first, so that the middle of all is the lower one of two in the middle. What
/// it gives where the pixel itself is rejected is of no use.
template <int radius, class Tag>
class GuidedMedian {
    using V = hn::Vec<Tag>;
    static constexpr int side = 2 * radius + 1;
    static constexpr std::size_t count = side * side;
    // Some registers hold what all samples are compared with, and what is worked out.
    static constexpr std::size_t registers = many_registers ? 26 : 11;
    static constexpr auto& steps = median_steps<count, registers>;

public:
    HWY_INLINE GuidedMedian(const SampleRows<radius>& rows, int x)
        : rows_(rows), x_(x), intensity_(hn::LoadU(tag_, rows.intensities[radius] + radius + x)) {}

    HWY_INLINE V value() {
        run<0, steps.size()>();
        return values_[count / 2];
    }

private:
    // By halves: clang folds no more than 256 expressions into one.
    template <std::size_t first, std::size_t size>
    HWY_INLINE void run() {
        if constexpr (size == 1) {
            step<first>();
        } else {
            run<first, size / 2>();
            run<first + size / 2, size - size / 2>();
        }
    }

    // A sample is looked at when it is first needed: so few wait at a time.
    template <std::size_t i>
    HWY_INLINE void step() {
        constexpr ExchangeStep now = steps[i];
        if constexpr (now.low_is_new) {
            values_[now.exchange.low] = sample<now.exchange.low>();
        }
        if constexpr (now.high_is_new) {
            values_[now.exchange.high] = sample<now.exchange.high>();
        }
        order(values_[now.exchange.low], values_[now.exchange.high]);
    }

    template <std::size_t place>
    HWY_INLINE V sample() {
        constexpr int row = static_cast<int>(place) / side;
        constexpr int column = static_cast<int>(place) % side;
        const V difference = hn::Abs(hn::Sub(hn::LoadU(tag_, rows_.intensities[row] + x_ + column), intensity_));
        const auto unlike = hn::Gt(difference, tolerance_);
        filler_ = hn::IfThenElse(unlike, hn::Not(filler_), filler_);
        return hn::IfThenElse(unlike, filler_, hn::LoadU(tag_, rows_.disparities[row] + x_ + column));
    }

    Tag tag_{};
    const SampleRows<radius>& rows_;
    int x_;
    V intensity_;
    V tolerance_ = hn::Set(tag_, static_cast<std::int16_t>(guided_median_tolerance));
    V filler_ = hn::Set(tag_, std::int16_t{32767});
    V values_[count];
};

template <int radius>
void guided_median_of_columns(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid_value,
                              int first, int columns, Plane<std::int16_t> out, Rows rows) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    GuidedSamples<radius> samples(in, guide, invalid_value, first, columns, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        samples.move_to(y);
        const SampleRows<radius> window(samples, y);
        std::int16_t* to = out.row(y) + first;
        for (int x = 0; x < columns; x += lanes) {
            const auto is_rejected = hn::Eq(hn::LoadU(tag, samples.disparities(y) + x), invalid);
            const auto middle =
                hn::IfThenElse(is_rejected, invalid, GuidedMedian<radius, decltype(tag)>(window, x).value());
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
