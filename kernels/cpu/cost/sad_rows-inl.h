// SPDX-License-Identifier: Apache-2.0
// Step 2 of docs/algorithm.md by running sums: a row of sums over the window's height for each column and candidate,
// to which each image row adds its new row of differences and takes the oldest away; and along the row a sum over the
// window's width, moved on in the same way. Sums are keys of running_argmin-inl.h: they hold an index from the start.
#if defined(DISPARITYD_CPU_COST_SAD_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_SAD_ROWS_INL_H_
#undef DISPARITYD_CPU_COST_SAD_ROWS_INL_H_
#else
#define DISPARITYD_CPU_COST_SAD_ROWS_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/match_layout.h"
#include "kernels/cpu/simd/image_rows-inl.h"
#include "kernels/cpu/winner/running_argmin-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int sad_radius_x = 4;
constexpr int sad_radius_y = 3;
constexpr std::uint16_t sad_outside = (2 * sad_radius_x + 1) * (2 * sad_radius_y + 1) * 255;

/// Two rows of an image, a byte of each in turn: of the row that a window gains and of the one that it loses.
class RowPair {
public:
    void set(const std::uint8_t* gained, const std::uint8_t* lost, int count) {
        const hn::ScalableTag<std::uint8_t> tag;
        const int lanes = static_cast<int>(hn::Lanes(tag));
        auto* out = reinterpret_cast<std::uint8_t*>(pairs_);
        int i = 0;
        for (; i + lanes <= count; i += lanes) {
            hn::StoreInterleaved2(hn::LoadU(tag, gained + i), hn::LoadU(tag, lost + i), tag, out + 2 * i);
        }
        for (; i < count; ++i) {
            out[2 * i] = gained[i];
            out[2 * i + 1] = lost[i];
        }
    }

    const std::uint16_t* pairs() const { return pairs_; }

private:
    alignas(64) std::uint16_t pairs_[max_side + max_disparities + 2 * row_slack];
};

/// Two rows of the right image: mirrored as census_right() has it, split by residue, the border replicated as far as
/// candidates reach.
template <int stride>
class MirroredRows {
public:
    void set(const MatchGeometry& geometry, const std::uint8_t* gained, const std::uint8_t* lost) {
        const int entries = geometry.width + geometry.layout.candidates();
        mirror_row(geometry, gained, gained_);
        mirror_row(geometry, lost, lost_);
        pair_.set(gained_, lost_, entries);
        split<stride>(pair_.pairs(), entries, split_, pitch);
        for (int i = 0; i + 1 < stride; ++i) {
            std::copy_n(split_ + i * pitch + 1, entries / stride + 1, split_ + (stride + i) * pitch);
        }
    }

    /// Entry i, and the `stride - 1` entries after it each `pitch` words further.
    const std::uint16_t* entry(int i) const {
        const auto number = static_cast<unsigned>(i);
        return split_ + number % stride * pitch + number / stride;
    }

    static constexpr int pitch = ((max_side + max_disparities) / stride + 63) / 64 * 64 + row_slack;

private:
    static void mirror_row(const MatchGeometry& geometry, const std::uint8_t* row, std::uint8_t* to) {
        const int width = geometry.width;
        const int entries = width + geometry.layout.candidates();
        const int first = std::clamp(-geometry.range.first, 0, entries);  // entries before it are right of the image
        const int end = std::clamp(width - geometry.range.first, 0, entries);
        std::fill_n(to, first, row[width - 1]);
        if (end > first) {
            mirror(row + width - geometry.range.first - end, end - first, to + first);
        }
        std::fill_n(to + end, entries - end, row[0]);
    }

    std::uint8_t gained_[max_side + max_disparities];
    std::uint8_t lost_[max_side + max_disparities];
    RowPair pair_;
    // The first residues stand there twice, the second time from their second entry on.
    alignas(64) std::uint16_t split_[(2 * stride - 1) * pitch];
};

/// Of each residue a row of keys, as many as a vector has lanes each time: of candidates outside the right image, of 0,
/// and of candidates outside.
template <int stride, int lanes>
class OutsideKeys {
public:
    constexpr OutsideKeys() {
        for (int q = 0; q < stride; ++q) {
            for (int i = 0; i < lanes; ++i) {
                const int key = sad_outside << index_bits | index_of_residue<stride>(q);
                rows_[q][i] = rows_[q][2 * lanes + i] = static_cast<std::uint16_t>(key);
            }
        }
    }

    constexpr const std::uint16_t* of(unsigned q) const { return rows_[q]; }

private:
    std::uint16_t rows_[stride][3 * lanes] = {};
};
template <int stride, int lanes>
inline constexpr OutsideKeys<stride, lanes> outside_keys;

template <class Tag, int registers>
class SadRows {
    using Words = hn::Repartition<std::uint16_t, Tag>;
    using V = hn::Vec<Tag>;
    using W = hn::Vec<Words>;
    using Right = MirroredRows<2 * registers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));
    static constexpr int stride = 2 * registers;
    static constexpr int candidates = stride * lanes;
    static_assert(sad_outside <= largest_sum);

public:
    static std::size_t scratch_bytes(const MatchGeometry& geometry) {
        return sizeof(std::uint16_t) * static_cast<std::size_t>(geometry.width) * candidates;
    }

    SadRows(const MatchGeometry& geometry, Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
            std::uint8_t* scratch)
        : geometry_(geometry), left_(left), right_(right), columns_(reinterpret_cast<std::uint16_t*>(scratch)) {}

    void begin(int y) {
        std::fill_n(columns_, static_cast<std::ptrdiff_t>(geometry_.width) * candidates, std::uint16_t{0});
        static constexpr std::uint8_t nothing[max_side] = {};
        for (int dy = -sad_radius_y; dy <= sad_radius_y; ++dy) {
            move_columns(left_.row(inside(y + dy)), nothing, right_.row(inside(y + dy)), nothing);
        }
    }

    /// From y - 1 to y.
    void move_to(int y) {
        const int gained = inside(y + sad_radius_y);
        const int lost = inside(y - 1 - sad_radius_y);
        move_columns(left_.row(gained), left_.row(lost), right_.row(gained), right_.row(lost));
    }

    /// The sums of the row's windows, moved on from pixel to pixel, as WinnerSearch::run() asks for them.
    class WindowSums {
    public:
        explicit WindowSums(const SadRows& rows) : rows_(rows) {
            const int last = rows.geometry_.width - 1;
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                sum_[q] = hn::Set(Words(), index_of_residue<stride>(q));
                for (int dx = -sad_radius_x; dx <= sad_radius_x; ++dx) {
                    sum_[q] = hn::Add(sum_[q], hn::Load(Words(), rows.column(std::clamp(dx, 0, last)) + q * lanes));
                }
            }
        }

        template <class Take>
        HWY_INLINE void operator()(int x, int count, Take take) {
            if (rows_.are_whole(x, count)) {
                move<false>(x, count, take);
            } else {
                move<true>(x, count, take);
            }
        }

    private:
        template <bool near_end, class Take>
        HWY_INLINE void move(int x, int count, Take take) {
            // Copies that nobody else can see stay in registers.
            const int last = rows_.geometry_.width - 1;
            const DisparityRange range = rows_.geometry_.range;
            W sum[stride];
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                sum[q] = sum_[q];
            }
            const std::uint16_t* next = rows_.column(std::min(x + 1 + sad_radius_x, last));
            const std::uint16_t* oldest = rows_.column(std::max(x - sad_radius_x, 0));
            for (int i = 0; i < count; ++i) {
                if constexpr (near_end) {
                    W key[stride];
                    keys_of(x + i, last, range, sum, key);
                    take(i, key);
                } else {
                    take(i, sum);
                }
                DISPARITYD_UNROLL
                for (int q = 0; q < stride; ++q) {
                    const W more = hn::Add(sum[q], hn::Load(Words(), next + q * lanes));
                    sum[q] = hn::Sub(more, hn::Load(Words(), oldest + q * lanes));
                }
                next += !near_end || x + i + 1 + sad_radius_x < last ? candidates : 0;
                oldest += !near_end || x + i >= sad_radius_x ? candidates : 0;
            }
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                sum_[q] = sum[q];
            }
        }

        const SadRows& rows_;
        W sum_[stride];
    };

private:
    int inside(int y) const { return std::clamp(y, 0, left_.height - 1); }
    std::uint16_t* column(int x) const { return columns_ + static_cast<std::ptrdiff_t>(x) * candidates; }

    // Entry width - 1 - x is candidate 0 of pixel x: its residue is one less at each pixel of a group.
    static constexpr int pixels_at_once = stride % 4 == 0 ? 4 : stride % 3 == 0 ? 3 : 2;

    void move_columns(const std::uint8_t* left_gained, const std::uint8_t* left_lost, const std::uint8_t* right_gained,
                      const std::uint8_t* right_lost) {
        const int width = geometry_.width;
        left_rows_.set(left_gained, left_lost, width);
        right_rows_.set(geometry_, right_gained, right_lost);
        const std::uint16_t* left = left_rows_.pairs();
        int x = 0;
        for (; (width - x) % pixels_at_once != 0; ++x) {
            move_column(left + x, right_rows_.entry(width - 1 - x), column(x));
        }
        for (; x < width; x += pixels_at_once) {
            const std::uint16_t* right = right_rows_.entry(width - 1 - x);
            std::uint16_t* sums = column(x);
            DISPARITYD_UNROLL
            for (int first = 0; first < stride; first += pixels_at_once) {
                move_group(left + x, right + first * Right::pitch, sums + first * lanes);
            }
        }
    }

    // As many residues of a group of pixels: what residue q has at a pixel, residue q + 1 has at the next one.
    static HWY_INLINE void move_group(const std::uint16_t* left, const std::uint16_t* right, std::uint16_t* sums) {
        constexpr int earlier = pixels_at_once - 1;
        V there[earlier + pixels_at_once];
        DISPARITYD_UNROLL
        for (int i = 0; i < earlier + pixels_at_once; ++i) {
            there[i] = hn::BitCast(Tag(), hn::LoadU(Words(), right + (i - earlier) * Right::pitch));
        }
        DISPARITYD_UNROLL
        for (int i = 0; i < pixels_at_once; ++i) {
            const V here = hn::BitCast(Tag(), broadcast(Words(), left + i));
            DISPARITYD_UNROLL
            for (int q = 0; q < pixels_at_once; ++q) {
                add_difference(here, there[earlier + q - i], sums + i * candidates + q * lanes);
            }
        }
    }

    static HWY_INLINE void move_column(const std::uint16_t* left, const std::uint16_t* right, std::uint16_t* sums) {
        const V here = hn::BitCast(Tag(), broadcast(Words(), left));
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            const V there = hn::BitCast(Tag(), hn::LoadU(Words(), right + q * Right::pitch));
            add_difference(here, there, sums + q * lanes);
        }
    }

    static HWY_INLINE void add_difference(V here, V there, std::uint16_t* sums) {
        const W change = difference_of_bytes<index_bits>(Words(), absolute_difference(here, there));
        hn::Store(hn::Add(hn::Load(Words(), sums), change), Words(), sums);
    }

    /// Whether pixels x .. x + count - 1 have whole windows and all candidates.
    bool are_whole(int x, int count) const {
        const int last = x + count - 1;
        const DisparityRange range = geometry_.range;
        return x >= sad_radius_x && last + 1 + sad_radius_x < geometry_.width && x >= range.first + range.count - 1 &&
               last <= range.first + geometry_.width - 1;
    }

    /// The keys of pixel x from its sums: those of candidates outside the right image are not what columns say.
    static HWY_INLINE void keys_of(int x, int last_x, DisparityRange range, const W* sums, W* keys) {
        const int left = range.first + candidates - 1 - x;  // how many of the last candidates are left of the image
        const int right = x - range.first - last_x;         // how many of the first are right of it
        // No sum is larger than one of a candidate outside. Numbers without a sign are divided with fewer instructions.
        const auto most = [](int number) { return static_cast<unsigned>(std::min(number, candidates)); };
        const auto row_of_zeros = [](unsigned q) { return outside_keys<stride, lanes>.of(q) + lanes; };
        DISPARITYD_UNROLL
        for (unsigned q = 0; q < stride; ++q) {
            keys[q] = sums[q];
            if (left > 0) {
                keys[q] = hn::Max(keys[q], hn::LoadU(Words(), row_of_zeros(q) + (most(left) + q) / stride));
            }
            if (right > 0) {
                const unsigned last_residue = stride - 1;
                keys[q] =
                    hn::Max(keys[q], hn::LoadU(Words(), row_of_zeros(q) - (most(right) + last_residue - q) / stride));
            }
        }
    }

    const MatchGeometry& geometry_;
    Plane<const std::uint8_t> left_;
    Plane<const std::uint8_t> right_;
    std::uint16_t* columns_;
    RowPair left_rows_;
    Right right_rows_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
