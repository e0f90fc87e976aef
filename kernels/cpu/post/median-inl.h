// SPDX-License-Identifier: Apache-2.0
// Step 9 of docs/algorithm.md: median of 3x3 or 5x5, by a fixed sequence of minima and maxima on vectors of pixels.
#if defined(DISPARITYD_CPU_POST_MEDIAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_MEDIAN_INL_H_
#undef DISPARITYD_CPU_POST_MEDIAN_INL_H_
#else
#define DISPARITYD_CPU_POST_MEDIAN_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Puts the lesser of each lane first.
template <class V>
HWY_INLINE void order(V& a, V& b) {
    const V lesser = hn::Min(a, b);
    b = hn::Max(a, b);
    a = lesser;
}

/// Three or five values that lie `step` apart, in ascending order.
template <int count, int step, class V>
HWY_INLINE void sort(V* v) {
    if constexpr (count == 3) {
        order(v[0], v[step]), order(v[step], v[2 * step]), order(v[0], v[step]);
    } else {
        static_assert(count == 5);
        order(v[0], v[step]), order(v[3 * step], v[4 * step]), order(v[2 * step], v[4 * step]);
        order(v[2 * step], v[3 * step]), order(v[step], v[4 * step]), order(v[0], v[3 * step]);
        order(v[0], v[2 * step]), order(v[step], v[3 * step]), order(v[step], v[2 * step]);
    }
}

/// The middle one of each lane: the least of those left is put in front, until the middle is reached.
template <int count, class V>
HWY_INLINE V median_of(V* values) {
    DISPARITYD_UNROLL
    for (int pass = 0; pass <= count / 2; ++pass) {
        DISPARITYD_UNROLL
        for (int i = pass + 1; i < count; ++i) {
            order(values[pass], values[i]);
        }
    }
    return values[count / 2];
}

/// With columns and then rows in order (columns stay so), a value is not less than (row + 1) (column + 1) - 1 others,
/// and not more than as many as seen from the other corner: whether it can be in the middle.
template <int side>
constexpr bool can_be_median(int row, int column) {
    constexpr int half = side * side / 2;
    return (row + 1) * (column + 1) <= half + 1 && (side - row) * (side - column) <= half + 1;
}

template <int side>
constexpr int medians_possible() {
    int count = 0;
    for (int i = 0; i < side * side; ++i) {
        count += can_be_median<side>(i / side, i % side) ? 1 : 0;
    }
    return count;
}

/// The middle one of a square of values. Of those that cannot be it, as many are surely less as are surely more.
/// Compilers leave away what no candidate needs.
template <int side, class V>
HWY_INLINE V median_of_square(V* values) {
    DISPARITYD_UNROLL
    for (int column = 0; column < side; ++column) {
        sort<side, side>(values + column);
    }
    DISPARITYD_UNROLL
    for (int row = 0; row < side; ++row) {
        sort<side, 1>(values + side * row);
    }
    constexpr int possible = medians_possible<side>();
    V candidates[possible];
    int count = 0;
    DISPARITYD_UNROLL
    for (int row = 0; row < side; ++row) {
        DISPARITYD_UNROLL
        for (int column = 0; column < side; ++column) {
            if (can_be_median<side>(row, column)) {
                candidates[count++] = values[side * row + column];
            }
        }
    }
    return median_of<possible>(candidates);
}

/// Rows of the window with their ends replicated.
template <int radius>
class MedianWindow {
public:
    static constexpr int side = 2 * radius + 1;

    MedianWindow(Plane<const std::int16_t> in, int first) : in_(in) {
        for (int y = first - radius; y < first + radius; ++y) {
            load(y);
        }
    }

    void move_to(int y) { load(y + radius); }
    const std::int16_t* row(int y) const { return &rows_[(y + ring) % ring][margin]; }

private:
    static constexpr int margin = 32;
    static constexpr int ring = 8;

    void load(int y) {
        const std::int16_t* in = in_.row(std::clamp(y, 0, in_.height - 1));
        std::int16_t* out = &rows_[(y + ring) % ring][margin];
        std::copy_n(in, in_.width, out);
        std::fill_n(out - radius, radius, out[0]);
        std::fill_n(out + in_.width, radius, out[in_.width - 1]);
    }

    Plane<const std::int16_t> in_;
    std::int16_t rows_[ring][max_side + 3 * margin] = {};
};

template <int radius>
void median_rows(Plane<const std::int16_t> in, std::int16_t invalid_value, Plane<std::int16_t> out, Rows rows) {
    constexpr int side = 2 * radius + 1;
    const hn::ScalableTag<std::int16_t> tag;
    using V = hn::Vec<decltype(tag)>;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const V invalid = hn::Set(tag, invalid_value);
    MedianWindow<radius> window(in, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        window.move_to(y);
        for (int x = 0; x < in.width; x += lanes) {
            const V centre = hn::LoadU(tag, window.row(y) + x);
            V values[side * side];
            for (int dy = -radius; dy <= radius; ++dy) {
                const std::int16_t* row = window.row(y + dy) + x;
                for (int dx = -radius; dx <= radius; ++dx) {
                    const V value = hn::LoadU(tag, row + dx);
                    values[(dy + radius) * side + dx + radius] = hn::IfThenElse(hn::Eq(value, invalid), centre, value);
                }
            }
            const V middle = hn::IfThenElse(hn::Eq(centre, invalid), invalid, median_of_square<side>(values));
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

inline void median(Plane<const std::int16_t> in, std::int16_t invalid, int size, Plane<std::int16_t> out, Rows rows) {
    if (size == 3) {
        median_rows<1>(in, invalid, out, rows);
    } else {
        median_rows<2>(in, invalid, out, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
