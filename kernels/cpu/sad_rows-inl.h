// SPDX-License-Identifier: Apache-2.0
// Step 2 of docs/algorithm.md by running sums: a row of sums over the window's height for each column and candidate,
// to which each image row adds its new row of differences and takes the oldest away; and along the row a sum over the
// window's width, moved on in the same way. Sums are words in the classes of winner_row-inl.h.
#if defined(DISPARITYD_CPU_SAD_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SAD_ROWS_INL_H_
#undef DISPARITYD_CPU_SAD_ROWS_INL_H_
#else
#define DISPARITYD_CPU_SAD_ROWS_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/census_planes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int sad_radius_x = 4;
constexpr int sad_radius_y = 3;
constexpr std::int16_t sad_outside = (2 * sad_radius_x + 1) * (2 * sad_radius_y + 1) * 255;

/// A row of the right image for absolute differences: mirrored as census_right() has it, split by register, its border
/// replicated as far as candidates reach.
template <int registers>
class MirroredRow {
public:
    void set(const SgmGeometry& geometry, const std::uint8_t* row) {
        const int width = geometry.width;
        const int entries = width + geometry.layout.candidates();
        const int first = std::clamp(-geometry.range.first, 0, entries);  // entries before it are right of the image
        const int end = std::clamp(width - geometry.range.first, 0, entries);
        std::fill_n(mirrored_, first, row[width - 1]);
        if (end > first) {
            mirror(row + width - geometry.range.first - end, end - first, mirrored_ + first);
        }
        std::fill_n(mirrored_ + end, entries - end, row[0]);
        split<registers>(mirrored_, entries, parts_, part);
    }

    const std::uint8_t* entry(int i) const { return parts_ + i % registers * part + i / registers; }

private:
    static constexpr int longest = max_side + max_disparities;
    static constexpr int part = (longest / registers + 63) / 64 * 64 + row_slack;

    alignas(64) std::uint8_t mirrored_[longest + 4 * row_slack] = {};
    alignas(64) std::uint8_t parts_[part * registers] = {};
};

template <class Tag, int registers>
class SadRows {
    using Words = hn::Repartition<std::int16_t, Tag>;
    using V = hn::Vec<Tag>;
    using W = hn::Vec<Words>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));
    static constexpr int classes = 2 * registers;
    static constexpr int candidates = classes * lanes;

public:
    static std::size_t scratch_bytes(const SgmGeometry& geometry) {
        return sizeof(std::int16_t) * static_cast<std::size_t>(geometry.width) * candidates;
    }

    SadRows(const SgmGeometry& geometry, Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
            std::uint8_t* scratch)
        : geometry_(geometry), left_(left), right_(right), columns_(reinterpret_cast<std::int16_t*>(scratch)) {}

    void begin(int y) {
        std::fill_n(columns_, static_cast<std::ptrdiff_t>(geometry_.width) * candidates, std::int16_t{0});
        for (int dy = -sad_radius_y; dy <= sad_radius_y; ++dy) {
            new_.set(geometry_, right_.row(inside(y + dy)));
            add_row<false>(left_.row(inside(y + dy)), nullptr);
        }
    }

    /// From y - 1 to y.
    void move_to(int y) {
        const int added = inside(y + sad_radius_y);
        const int taken = inside(y - 1 - sad_radius_y);
        new_.set(geometry_, right_.row(added));
        old_.set(geometry_, right_.row(taken));
        add_row<true>(left_.row(added), left_.row(taken));
    }

    /// The sums of the row's windows, moved on from pixel to pixel: to be called for x = 0, x = count, ..; candidates
    /// of one pixel after the other go to `out`, class after class.
    class WindowSums {
    public:
        explicit WindowSums(const SadRows& rows) : rows_(rows) {
            const int last = rows.geometry_.width - 1;
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                sum_[q] = hn::Zero(Words());
                for (int dx = -sad_radius_x; dx <= sad_radius_x; ++dx) {
                    sum_[q] = hn::Add(sum_[q], hn::Load(Words(), rows.column(std::clamp(dx, 0, last)) + q * lanes));
                }
            }
        }

        void operator()(int x, int count, std::int16_t* out) {
            if (x >= sad_radius_x && x + count + sad_radius_x < rows_.geometry_.width) {
                move<false>(x, count, out);
            } else {
                move<true>(x, count, out);
            }
            rows_.set_outside(x, count, out);
        }

    private:
        template <bool near_end>
        HWY_INLINE void move(int x, int count, std::int16_t* out) {
            const int last = rows_.geometry_.width - 1;
            // A copy that nobody else can see stays in registers.
            W sum[classes];
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                sum[q] = sum_[q];
            }
            const auto next_of = [&](int i) { return rows_.column(std::min(x + i + 1 + sad_radius_x, last)); };
            const auto oldest_of = [&](int i) { return rows_.column(std::max(x + i - sad_radius_x, 0)); };
            const std::int16_t* next = next_of(0);
            const std::int16_t* oldest = oldest_of(0);
            for (int i = 0; i < count; ++i) {
                DISPARITYD_UNROLL
                for (int q = 0; q < classes; ++q) {
                    hn::Store(sum[q], Words(), out + q * lanes);
                    const W more = hn::Add(sum[q], hn::Load(Words(), next + q * lanes));
                    sum[q] = hn::Sub(more, hn::Load(Words(), oldest + q * lanes));
                }
                next = near_end ? next_of(i + 1) : next + candidates;
                oldest = near_end ? oldest_of(i + 1) : oldest + candidates;
                out += candidates;
            }
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                sum_[q] = sum[q];
            }
        }

        const SadRows& rows_;
        W sum_[classes];
    };

private:
    int inside(int y) const { return std::clamp(y, 0, left_.height - 1); }
    std::int16_t* column(int x) const { return columns_ + static_cast<std::ptrdiff_t>(x) * candidates; }

    HWY_INLINE static V difference(V a, V b) { return hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a)); }

    // Entry of a pixel and register. `registers` pixels later the same register has the entry before, in the same part.
    static constexpr int pixels_at_once = registers;

    template <bool take_old>
    void add_row(const std::uint8_t* added, const std::uint8_t* taken) {
        const std::uint8_t* new_entries[2 * registers - 1];
        const std::uint8_t* old_entries[2 * registers - 1];
        const int width = geometry_.width;
        int x = 0;
        const auto point = [&](int count) {
            for (int i = 0; i < registers + count - 1; ++i) {
                new_entries[i] = new_.entry(width - x - count + i);
                old_entries[i] = old_.entry(width - x - count + i);
            }
        };
        if (width >= pixels_at_once) {
            point(pixels_at_once);
        }
        for (std::ptrdiff_t block = 0; x + pixels_at_once <= width; x += pixels_at_once, ++block) {
            DISPARITYD_UNROLL
            for (int i = 0; i < pixels_at_once; ++i) {
                const int first = pixels_at_once - 1 - i;
                add_pixel<take_old>(x + i, added, taken, new_entries + first, old_entries + first, block);
            }
        }
        for (; x < width; ++x) {
            point(1);
            add_pixel<take_old>(x, added, taken, new_entries, old_entries, 0);
        }
    }

    // Register r's differences are to what stands `back` bytes before new_entries[r] and old_entries[r].
    template <bool take_old>
    HWY_INLINE void add_pixel(int x, const std::uint8_t* added, const std::uint8_t* taken,
                              const std::uint8_t* const* new_entries, const std::uint8_t* const* old_entries,
                              std::ptrdiff_t back) {
        const Tag bytes;
        const Words words;
        const hn::Repartition<std::uint16_t, Tag> unsigned_words;
        const V here = hn::Set(bytes, added[x]);
        const V there = hn::Set(bytes, take_old ? taken[x] : std::uint8_t{0});
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const V more = difference(here, hn::LoadU(bytes, new_entries[r] - back));
            auto even = words_of_bytes<false>(unsigned_words, more);
            auto odd = words_of_bytes<true>(unsigned_words, more);
            if constexpr (take_old) {
                const V less = difference(there, hn::LoadU(bytes, old_entries[r] - back));
                even = hn::Sub(even, words_of_bytes<false>(unsigned_words, less));
                odd = hn::Sub(odd, words_of_bytes<true>(unsigned_words, less));
            }
            std::int16_t* even_sums = column(x) + r * lanes;
            std::int16_t* odd_sums = column(x) + (r + registers) * lanes;
            hn::Store(hn::Add(hn::Load(words, even_sums), hn::BitCast(words, even)), words, even_sums);
            hn::Store(hn::Add(hn::Load(words, odd_sums), hn::BitCast(words, odd)), words, odd_sums);
        }
    }

    // Candidates outside the right image, of pixels x .. x + count - 1: those near an end of the row have some.
    void set_outside(int x, int count, std::int16_t* sums) const {
        const DisparityRange range = geometry_.range;
        const int first_whole = range.first + range.count - 1;
        const int last_whole = range.first + geometry_.width - 1;
        for (int i = 0; i < count; ++i) {
            if (x + i >= first_whole && x + i <= last_whole) {
                i = std::min(last_whole - x, count - 1);
                continue;
            }
            set_outside(x + i, sums + i * candidates);
        }
    }

    HWY_INLINE void set_outside(int x, std::int16_t* sums) const {
        const DisparityRange range = geometry_.range;
        const int first = std::clamp(x - (geometry_.width - 1) - range.first, 0, range.count);
        const int last = std::clamp(x + 1 - range.first, first, range.count);
        const W first_inside = hn::Set(Words(), static_cast<std::int16_t>(first));
        const W last_inside = hn::Set(Words(), static_cast<std::int16_t>(last - 1));
        for (int q = 0; q < classes; ++q) {
            const W k = hn::Add(hn::Mul(hn::Iota(Words(), 0), hn::Set(Words(), std::int16_t{classes})),
                                hn::Set(Words(), static_cast<std::int16_t>(q)));
            const auto outside = hn::Or(hn::Lt(k, first_inside), hn::Lt(last_inside, k));
            const W sum = hn::Load(Words(), sums + q * lanes);
            hn::Store(hn::IfThenElse(outside, hn::Set(Words(), sad_outside), sum), Words(), sums + q * lanes);
        }
    }

    const SgmGeometry& geometry_;
    Plane<const std::uint8_t> left_;
    Plane<const std::uint8_t> right_;
    std::int16_t* columns_;
    MirroredRow<registers> new_;
    MirroredRow<registers> old_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
