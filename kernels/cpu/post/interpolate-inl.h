// SPDX-License-Identifier: Apache-2.0
// Step 11 of docs/algorithm.md: a pass downwards carries what lies above each pixel, a pass upwards what lies below,
// and on the way up the rejected pixels of each row are filled, a vector of them at a time.
#if defined(DISPARITYD_CPU_POST_INTERPOLATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_INTERPOLATE_INL_H_
#undef DISPARITYD_CPU_POST_INTERPOLATE_INL_H_
#else
#define DISPARITYD_CPU_POST_INTERPOLATE_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hwy/highway.h"
#include "kernels/cpu/post/right_support-inl.h"
#include "kernels/cpu/post/row_bits-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Of each pixel: in the direction (-1, 1), (0, 1) or (1, 1), with rows counted away from it; a disparity of its own is
/// the nearest. The invalid disparity where there is none.
struct NearestRow {
    std::int16_t* sides[3];
};

/// Memory for such rows.
class NearestRows {
public:
    static constexpr int margin = 32;  // a vector at most

    static std::size_t bytes(int width, int rows) {
        return static_cast<std::size_t>(rows) * 3 * static_cast<std::size_t>(stride(width)) * sizeof(std::int16_t);
    }
    NearestRows(std::byte* memory, int width)
        : memory_(reinterpret_cast<std::int16_t*>(memory)), stride_(stride(width)) {}

    NearestRow row(int i) const {
        std::int16_t* first = memory_ + 3 * i * stride_ + margin;
        return {{first, first + stride_, first + 2 * stride_}};
    }
    void clear(int i, std::int16_t invalid) const { std::fill_n(memory_ + 3 * i * stride_, 3 * stride_, invalid); }

private:
    static std::ptrdiff_t stride(int width) { return margin + (width + margin - 1) / margin * margin + margin; }

    std::int16_t* memory_;
    std::ptrdiff_t stride_;
};

/// Carries `previous`, of the row that the pass comes from, on to `row`. `pixels`: disparities of the row.
inline void carry(const std::int16_t* pixels, int width, std::int16_t invalid_value, const NearestRow& previous,
                  const NearestRow& row) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    alignas(64) std::int16_t last[lanes];
    int x = 0;
    for (; x < width; x += lanes) {
        const std::int16_t* from = pixels + x;
        if (x + lanes > width) {
            std::fill_n(last, lanes, invalid_value);
            std::copy_n(from, width - x, last);
            from = last;
        }
        const auto own = hn::LoadU(tag, from);
        const auto rejected = hn::Eq(own, invalid);
        for (int side = 0; side < 3; ++side) {
            const auto carried = hn::LoadU(tag, previous.sides[side] + x + side - 1);
            hn::StoreU(hn::IfThenElse(rejected, carried, own), tag, row.sides[side] + x);
        }
    }
    // Beside the image nothing comes in.
    for (std::int16_t* side : row.sides) {
        side[-1] = invalid_value;
        side[x] = invalid_value;
    }
}

class FilledRow {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using V = hn::Vec<Numbers>;
    using M = hn::Mask<Numbers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    explicit FilledRow(std::int16_t invalid) : invalid_(invalid) {}

    bool any_rejected(const PaddedRow& row, int width) {
        bool any = false;
        for (int first = 0; first < width; first += 64) {
            const std::uint64_t word = equal_bits(row.pixels() + first, invalid_);
            const int rest = width - first;
            rejected_.words[first / 64] = rest < 64 ? word & ((std::uint64_t{1} << rest) - 1) : word;
            any = any || rejected_.words[first / 64] != 0;
        }
        return any;
    }

    /// `row` and `out` may not be the same.
    void fill(const PaddedRow& row, int width, const std::uint8_t* support, const NearestRow& above,
              const NearestRow& below, std::int16_t* out) {
        find_ends(row.pixels(), width);
        for (int x = 0; x < width; x += lanes) {
            const V own = hn::Load(Numbers(), row.pixels() + x);
            const M rejected = hn::Eq(own, hn::Set(Numbers(), invalid_));
            V filled = own;
            if (!hn::AllFalse(Numbers(), rejected)) {
                filled = hn::IfThenElse(rejected, substitute(x, support, above, below), own);
            }
            if (x + lanes <= width) {
                hn::StoreU(filled, Numbers(), out + x);
            } else {
                alignas(64) std::int16_t last[lanes];
                hn::Store(filled, Numbers(), last);
                std::copy_n(last, width - x, out + x);
            }
        }
    }

private:
    static constexpr std::int16_t largest = 0x7fff;

    // The disparities at both ends of each run of rejected pixels, for every pixel of the run.
    void find_ends(const std::int16_t* pixels, int width) {
        int begin = -1;
        std::uint64_t last_bit = 0;  // of the previous word
        const auto run = [&](int end) {
            spread(pixels[begin - 1], begin, end, left_);
            spread(pixels[end], begin, end, right_);
            begin = -1;
        };
        for (int w = 0; 64 * w < width; ++w) {
            const std::uint64_t word = rejected_.words[w];
            for (std::uint64_t flips = word ^ (word << 1 | last_bit); flips != 0; flips &= flips - 1) {
                const int x = 64 * w + std::countr_zero(flips);
                begin < 0 ? static_cast<void>(begin = x) : run(x);
            }
            last_bit = word >> 63;
        }
        if (begin >= 0) {
            run(width);
        }
    }
    // May write up to a vector more, which later runs write over.
    static void spread(std::int16_t value, int begin, int end, std::int16_t* row) {
        for (int x = begin; x < end; x += lanes) {
            hn::StoreU(hn::Set(Numbers(), value), Numbers(), row + x);
        }
    }

    HWY_INLINE V substitute(int x, const std::uint8_t* support, const NearestRow& above,
                            const NearestRow& below) const {
        const hn::Rebind<std::uint8_t, Numbers> bytes;
        const V invalid = hn::Set(Numbers(), invalid_);
        const V none = hn::Set(Numbers(), largest);
        V values[8] = {hn::Load(Numbers(), left_ + x), hn::Load(Numbers(), right_ + x)};
        for (int side = 0; side < 3; ++side) {
            values[2 + side] = hn::LoadU(Numbers(), above.sides[side] + x);
            values[5 + side] = hn::LoadU(Numbers(), below.sides[side] + x);
        }
        V missing = hn::Zero(Numbers());  // minus their number
        V missing_in_row = missing;
        for (int i = 0; i < 8; ++i) {
            const M is_missing = hn::Eq(values[i], invalid);
            missing = hn::Add(missing, hn::VecFromMask(Numbers(), is_missing));
            missing_in_row = i == 1 ? missing : missing_in_row;
            values[i] = hn::IfThenElse(is_missing, none, values[i]);
        }
        const V min_in_row = hn::Min(values[0], values[1]);
        const V background = hn::IfThenElse(is(missing_in_row, -2), invalid, min_in_row);
        const auto is_supported = hn::PromoteTo(Numbers(), hn::LoadU(bytes, support + x));
        return hn::IfThenElse(is(is_supported, 0), background, lower_median(values, missing));
    }

    static HWY_INLINE M is(V v, int value) { return hn::Eq(v, hn::Set(Numbers(), static_cast<std::int16_t>(value))); }

    /// Of the eight less those missing, which are the largest.
    HWY_INLINE V lower_median(V* v, V missing) const {
        sort_lower_half(v);
        const auto more_than = [&](int count) {
            return hn::Lt(missing, hn::Set(Numbers(), static_cast<std::int16_t>(-count)));
        };
        V middle = hn::IfThenElse(more_than(1), v[2], v[3]);
        middle = hn::IfThenElse(more_than(3), v[1], middle);
        middle = hn::IfThenElse(more_than(5), v[0], middle);
        return hn::IfThenElse(more_than(7), hn::Set(Numbers(), invalid_), middle);
    }

    // Batcher's merge exchange; what only the upper half depends on is left away by compilers.
    static HWY_INLINE void sort_lower_half(V* v) {
        const auto order = [v](int a, int b) {
            const V smaller = hn::Min(v[a], v[b]);
            v[b] = hn::Max(v[a], v[b]);
            v[a] = smaller;
        };
        order(0, 4), order(1, 5), order(2, 6), order(3, 7);
        order(0, 2), order(1, 3), order(4, 6), order(5, 7);
        order(2, 4), order(3, 5);
        order(0, 1), order(2, 3), order(4, 5), order(6, 7);
        order(1, 4), order(3, 6);
        order(1, 2), order(3, 4), order(5, 6);
    }

    std::int16_t invalid_;
    RowBits rejected_;
    alignas(64) std::int16_t left_[max_side + 64] = {};
    alignas(64) std::int16_t right_[max_side + 64] = {};
};

/// The whole image, in two phases. First both passes go through it and leave only what enters each band of rows from
/// above and from below; then every band does its part of both passes again, close enough together to stay in the
/// cache, and fills its rows.
class Interpolation {
public:
    static constexpr int passes = 2;  // downwards, upwards

    static int bands_of(int height) { return (height + rows_of_band - 1) / rows_of_band; }
    static std::size_t bytes(int width, int height) {
        return NearestRows::bytes(width, height + 3 * passes * (bands_of(height) + 1));
    }

    Interpolation(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                  std::span<std::byte> scratch)
        : disparity_(disparity),
          right_winner_(right_winner),
          range_(range),
          invalid_(invalid_disparity(range)),
          bands_(bands_of(disparity.height)),
          rows_(scratch.data(), disparity.width) {
        rows_.clear(entering(0, 0), invalid_);
        rows_.clear(entering(1, bands_ - 1), invalid_);
    }

    int bands() const { return bands_; }

    void enter_bands(int pass) const {
        const int step = pass == 0 ? 1 : -1;
        NearestRow previous = rows_.row(entering(pass, pass == 0 ? 0 : bands_ - 1));
        for (int i = 0; i < disparity_.height; ++i) {
            const int y = pass == 0 ? i : disparity_.height - 1 - i;
            const int next = y + step;
            const bool enters = next >= 0 && next < disparity_.height && next / rows_of_band != y / rows_of_band;
            const NearestRow now = rows_.row(enters ? entering(pass, next / rows_of_band) : in_work(pass, bands_, y));
            carry_row(y, previous, now);
            previous = now;
        }
    }

    /// One after the other, in the same memory: it stays in the cache.
    void fill_bands(int first, int last) const {
        PaddedRow pixels;
        FilledRow filled(invalid_);
        RightSupport support(range_);
        for (int band = first; band < last; ++band) {
            fill_band(band, first * rows_of_band, pixels, filled, support);
        }
    }

private:
    static constexpr int rows_of_band = 16;

    // `memory`: the first of the rows of memory for what lies above its rows.
    void fill_band(int band, int memory, PaddedRow& pixels, FilledRow& filled, RightSupport& support) const {
        const int first = band * rows_of_band;
        const int last = std::min(first + rows_of_band, disparity_.height);
        const auto above = [&](int y) { return rows_.row(memory + y - first); };
        for (int y = first; y < last; ++y) {
            carry_row(y, y == first ? rows_.row(entering(0, band)) : above(y - 1), above(y));
        }
        NearestRow previous = rows_.row(entering(1, band));
        for (int y = last - 1; y >= first; --y) {
            const NearestRow below = rows_.row(in_work(1, band, y));
            carry_row(y, previous, below);
            pixels.load(disparity_.row(y), disparity_.width, invalid_);
            if (filled.any_rejected(pixels, disparity_.width)) {
                support.row(right_winner_.row(y), disparity_.width);
                filled.fill(pixels, disparity_.width, support.pixels(), above(y), below, disparity_.row(y));
            }
            previous = below;
        }
    }

    // Rows of memory: as many as the image has, of which bands in work hold what lies above each of theirs; then three
    // for each band and pass, what enters it and two in work. Band number bands_ is the first phase, which goes through
    // all of them: only its two in work are used.
    int entering(int pass, int band) const { return disparity_.height + 3 * (passes * band + pass); }
    int in_work(int pass, int band, int y) const { return entering(pass, band) + 1 + y % 2; }

    void carry_row(int y, const NearestRow& previous, const NearestRow& now) const {
        carry(disparity_.row(y), disparity_.width, invalid_, previous, now);
    }

    Plane<std::int16_t> disparity_;
    Plane<const std::int16_t> right_winner_;
    DisparityRange range_;
    std::int16_t invalid_;
    int bands_;
    NearestRows rows_;
};

inline std::size_t interpolate_scratch(int width, int height) {
    return Interpolation::bytes(width, height);
}

inline void interpolate(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                        std::span<std::byte> scratch, Parallel& workers) {
    const Interpolation interpolation(disparity, right_winner, range, scratch);
    workers.for_each(Interpolation::passes, [&](int pass) { interpolation.enter_bands(pass); });
    const int bands = interpolation.bands();
    const int parts = workers.workers() == 1 ? 1 : std::min(bands, 4 * workers.workers());
    workers.for_each(parts,
                     [&](int part) { interpolation.fill_bands(bands * part / parts, bands * (part + 1) / parts); });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
