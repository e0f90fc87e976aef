// SPDX-License-Identifier: Apache-2.0
// The vote of step 9 of docs/algorithm.md.
#if defined(DISPARITYD_CPU_POST_VOTE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_VOTE_INL_H_
#undef DISPARITYD_CPU_POST_VOTE_INL_H_
#else
#define DISPARITYD_CPU_POST_VOTE_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/cpu/winner/left_results-inl.h"
#include "kernels/noise/noise_level.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int vote_radius = 2;

/// The rows around the row in work. What is rejected or outside the image is out of reach of every disparity: these
/// lie within 2^14.
class VoteWindow {
public:
    VoteWindow(Plane<const std::int16_t> in, std::int16_t invalid, int first) : in_(in), invalid_(invalid) {
        for (int y = first - vote_radius; y < first + vote_radius; ++y) {
            load(y);
        }
    }

    void move_to(int y) { load(y + vote_radius); }
    const std::int16_t* row(int y) const { return &rows_[(y + ring) % ring][margin]; }

    static constexpr std::int16_t nobody = 32767;

private:
    static constexpr int margin = 32;
    static constexpr int ring = 8;

    void load(int y) {
        std::int16_t* out = &rows_[(y + ring) % ring][margin];
        const int width = in_.width;
        if (y < 0 || y >= in_.height) {
            std::fill_n(out - vote_radius, width + 2 * vote_radius, nobody);
            return;
        }
        const hn::ScalableTag<std::int16_t> tag;
        constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
        alignas(64) std::int16_t last[lanes] = {};
        for (int x = 0; x < width; x += lanes) {
            const std::int16_t* in = in_.row(y) + x;
            if (x + lanes > width) {
                std::copy_n(in, width - x, last);
                in = last;
            }
            const auto own = hn::LoadU(tag, in);
            const auto rejected = hn::Eq(own, hn::Set(tag, invalid_));
            hn::StoreU(hn::IfThenElse(rejected, hn::Set(tag, nobody), own), tag, out + x);
        }
        std::fill_n(out - vote_radius, vote_radius, nobody);
        std::fill_n(out + width, vote_radius, nobody);
    }

    Plane<const std::int16_t> in_;
    std::int16_t invalid_;
    std::int16_t rows_[ring][max_side + 3 * margin] = {};
};

/// (sum + floor(count / 2)) / count in whole numbers, rounded down, for a sum of differences within the reach.
template <class V>
HWY_INLINE V mean_difference(V sum, V count) {
    const hn::DFromV<V> words;
    const hn::Repartition<std::int32_t, decltype(words)> numbers;
    const V reach = hn::Set(words, std::int16_t{vote_reach});
    // Nothing below 0, where the quotient would be rounded up.
    const V dividend = hn::Add(hn::Add(sum, hn::Mul(reach, count)), hn::ShiftRight<1>(count));
    const auto low =
        divide(hn::PromoteTo(numbers, hn::LowerHalf(dividend)), hn::PromoteTo(numbers, hn::LowerHalf(count)));
    const hn::Half<decltype(words)> half;
    const auto high = divide(hn::PromoteTo(numbers, hn::UpperHalf(half, dividend)),
                             hn::PromoteTo(numbers, hn::UpperHalf(half, count)));
    const V quotient = hn::Combine(words, hn::DemoteTo(half, high), hn::DemoteTo(half, low));
    return hn::Sub(quotient, reach);
}

/// 52 times the pixels of the window inside the image, of which `rows` rows are inside.
inline void set_limits(int width, int rows, std::int16_t* limits) {
    const auto limit = [rows](int columns) { return static_cast<std::int16_t>(vote_percent * rows * columns); };
    const auto set = [&](int x) {
        limits[x] = limit(std::min(x, vote_radius) + 1 + std::min(width - 1 - x, vote_radius));
    };
    std::fill_n(limits, width, limit(2 * vote_radius + 1));
    DISPARITYD_UNROLL
    for (int i = 0; i < vote_radius; ++i) {  // the window reaches beyond the image there
        set(std::min(i, width - 1));
        set(std::max(width - 1 - i, 0));
    }
}

inline void vote(Plane<const std::int16_t> in, std::int16_t invalid_value, Plane<std::int16_t> out, Rows rows) {
    const hn::ScalableTag<std::int16_t> tag;
    using V = hn::Vec<decltype(tag)>;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    alignas(64) std::int16_t limits[max_side + lanes] = {};
    int rows_of_limits = 0;
    const V beyond_reach = hn::Set(tag, std::int16_t{vote_reach + 1});
    const V one = hn::Set(tag, std::int16_t{1});
    VoteWindow window(in, invalid_value, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        window.move_to(y);
        const int inside = std::min(y, vote_radius) + 1 + std::min(in.height - 1 - y, vote_radius);
        if (inside != rows_of_limits) {
            set_limits(in.width, inside, limits);
            rows_of_limits = inside;
        }
        for (int x = 0; x < in.width; x += lanes) {
            const V own = hn::LoadU(tag, window.row(y) + x);
            V count = hn::Zero(tag);
            V sum = hn::Zero(tag);
            for (int dy = -vote_radius; dy <= vote_radius; ++dy) {
                const std::int16_t* row = window.row(y + dy) + x;
                DISPARITYD_UNROLL
                for (int dx = -vote_radius; dx <= vote_radius; ++dx) {
                    const V difference = hn::SaturatedSub(hn::LoadU(tag, row + dx), own);
                    const auto agrees = hn::Lt(hn::Abs(difference), beyond_reach);
                    count = hn::Add(count, hn::IfThenElseZero(agrees, one));
                    sum = hn::Add(sum, hn::IfThenElseZero(agrees, difference));
                }
            }
            const V share = hn::Mul(count, hn::Set(tag, std::int16_t{100}));
            const auto rejected =
                hn::Or(hn::Lt(share, hn::Load(tag, limits + x)), hn::Eq(own, hn::Set(tag, VoteWindow::nobody)));
            const V elected = hn::IfThenElse(rejected, hn::Set(tag, invalid_value),
                                             hn::Add(own, mean_difference(sum, hn::Max(count, one))));
            if (x + lanes <= in.width) {
                hn::StoreU(elected, tag, out.row(y) + x);
            } else {
                alignas(64) std::int16_t last[lanes];
                hn::Store(elected, tag, last);
                std::copy_n(last, in.width - x, out.row(y) + x);
            }
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
