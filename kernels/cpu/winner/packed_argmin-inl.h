// SPDX-License-Identifier: Apache-2.0
// Step 6 of docs/algorithm.md for one row of small sums: a sum and its candidate share a word, key = (sum << bits) +
// candidate, so that one minimum finds both, the smaller candidate of equal sums.
//
// Sums of 8 paths with P2 <= 63 are below 1024 and leave 6 bits, enough for the index of one of 64 candidates: with
// more, the 128-bit blocks of a register form groups of at most 64, each with a minimum of its own. Costs of CENSUS
// leave 8 bits, enough for all. Keys lie by residue (match_layout.h), so that a block of 8 lanes holds consecutive
// candidates.
#if defined(DISPARITYD_CPU_WINNER_PACKED_ARGMIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_PACKED_ARGMIN_INL_H_
#undef DISPARITYD_CPU_WINNER_PACKED_ARGMIN_INL_H_
#else
#define DISPARITYD_CPU_WINNER_PACKED_ARGMIN_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/simd/transpose_min-inl.h"
#include "kernels/cpu/winner/left_results-inl.h"
#include "kernels/cpu/winner/second_best-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// How keys of `stride` words per lane are grouped, by the `bits` of their index.
template <class Tag, int stride, int bits>
struct PackedGroups {
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int blocks = lanes / 8;
    static constexpr int block_size = 8 * stride;  ///< candidates of a block
    static constexpr bool possible = block_size <= 1 << bits;
    static constexpr int max_blocks = (1 << bits) / block_size;
    static constexpr int count = possible && max_blocks < blocks ? blocks / max_blocks : 1;
    static constexpr int group_size = block_size * blocks / count;  ///< candidates of a group
};

/// Made once, not for each row. `bias` is in all sums.
template <class Tag, int stride, int bits, int bias>
struct PackedTables {
    using Groups = PackedGroups<Tag, stride, bits>;
    static constexpr int candidates = stride * Groups::lanes;

    /// Added to a shifted sum, makes it a key: the index of candidate stride * lane + q, residue after residue.
    alignas(64) std::uint16_t indices[candidates] = {};
    /// no_key for all.
    alignas(64) std::uint16_t all_padding[candidates] = {};

    constexpr PackedTables() {
        for (int k = 0; k < candidates; ++k) {
            all_padding[k] = no_key;
            indices[CandidateLayout<stride, Groups::lanes>::of(k)] =
                static_cast<std::uint16_t>(k % Groups::group_size - (bias << bits));
        }
    }
};

template <class Tag, int stride, int bits, int bias>
inline constexpr PackedTables<Tag, stride, bits, bias> packed_tables;

/// The least block of each of `groups` equal parts of `v`.
template <int groups, class Tag, class Block>
HWY_INLINE void min_of_groups(Tag tag, hn::Vec<Tag> v, Block* out) {
    if constexpr (groups == 1) {
        out[0] = min_of_blocks(tag, v);
    } else {
        const hn::Half<Tag> half;
        min_of_groups<groups / 2>(half, hn::LowerHalf(half, v), out);
        min_of_groups<groups / 2>(half, hn::UpperHalf(half, v), out + groups / 2);
    }
}

/// Sum and candidate of the first of the least keys of all groups.
template <int bits, int groups, int group_size, class Tag>
HWY_INLINE void first_of_groups(Tag tag, const hn::Vec<Tag>* keys, hn::Vec<Tag>* sum, hn::Vec<Tag>* candidate) {
    const auto mask = hn::Set(tag, std::uint16_t{(1 << bits) - 1});
    *sum = hn::ShiftRight<bits>(keys[0]);
    *candidate = hn::And(keys[0], mask);
    DISPARITYD_UNROLL
    for (int g = 1; g < groups; ++g) {
        const auto s = hn::ShiftRight<bits>(keys[g]);
        const auto k = hn::Add(hn::And(keys[g], mask), hn::Set(tag, static_cast<std::uint16_t>(g * group_size)));
        *candidate = hn::IfThenElse(hn::Lt(s, *sum), k, *candidate);
        *sum = hn::Min(s, *sum);
    }
}

/// Winners of the right image: the least key along each diagonal of a block, carried from pixel to pixel.
template <class Tag, int stride, int bits>
class RightKeys {
    using V = hn::Vec<Tag>;
    using Groups = PackedGroups<Tag, stride, bits>;
    static constexpr int block_size = Groups::block_size;
    static constexpr int last_residue = stride - 1;

public:
    RightKeys() {
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            least_[q] = none_;
        }
    }

    /// Keys of the next pixel to the right. The last lane of each block of what is returned belongs to the right pixel
    /// whose candidates in this block are complete.
    HWY_INLINE V add(const V* keys) {
        const V first = hn::CombineShiftRightBytes<14>(tag_, least_[last_residue], none_);
        DISPARITYD_UNROLL
        for (int q = last_residue; q > 0; --q) {
            least_[q] = hn::Min(keys[q], least_[q - 1]);
        }
        least_[0] = hn::Min(keys[0], first);
        return least_[last_residue];
    }

    /// Least keys that are not complete: entry j of block b had the j-th candidate of the block last.
    HWY_INLINE void rest(std::uint16_t (*keys)[block_size]) const {
        alignas(64) std::uint16_t lanes[Groups::lanes];
        for (int q = 0; q < stride; ++q) {
            hn::Store(least_[q], tag_, lanes);
            for (int lane = 0; lane < Groups::lanes; ++lane) {
                keys[lane / 8][stride * (lane % 8) + q] = lanes[lane];
            }
        }
    }

private:
    Tag tag_{};
    V none_ = hn::Set(tag_, no_key);
    V least_[stride];
};

/// `bias` is in all sums.
template <class Tag, int stride, int bits, int bias>
class PackedArgmin {
    using V = hn::Vec<Tag>;
    using Groups = PackedGroups<Tag, stride, bits>;
    using Right = RightKeys<Tag, stride, bits>;
    static constexpr int lanes = Groups::lanes;
    static constexpr int candidates = stride * lanes;
    static_assert(Groups::possible);
    using Layout = CandidateLayout<stride, lanes>;

public:
    explicit PackedArgmin(const MatchGeometry& geometry)
        : width_(geometry.width), range_(geometry.range), layout_(range_.count) {
        std::copy_n(packed_tables<Tag, stride, bits, bias>.indices, candidates, indices_);
        std::fill_n(padding_, candidates, std::uint16_t{0});
        for (int k = range_.count; k < candidates; ++k) {
            padding_[Layout::of(k)] = no_key;
        }
    }

    /// keys(x, V* to) gives the sums of pixel x, shifted by `bits`.
    template <class Keys>
    void run(Keys keys, Minima& minima, std::int16_t* right_winner) {
        Right right;
        for (int x = 0; x < width_; x += 8) {
            eight_pixels(keys, x, right, minima);
            if (x >= 16) {  // eight later than it could be: what neighbours() may have stored has left the core by then
                second(x - 16, minima);
            }
        }
        const int last = (width_ - 1) / 8 * 8;
        if (last > 0) {
            second(last - 8, minima);
        }
        for (int x = last; x < width_; ++x) {
            neighbours(x, minima);
        }
        std::fill(minima.winner + width_, minima.winner + last + 8, std::int16_t{0});  // no candidate won there
        second(last, minima);
        sums_of_keys<bits>(minima.minus, width_);
        sums_of_keys<bits>(minima.plus, width_);
        finish_right(right, right_winner);
    }

private:
    // Of a right pixel, block b is complete at the left pixel of which it is the block's last candidate. Keys of left
    // pixels beside the image are none.
    static constexpr int right_origin = max_disparities + 64;
    static constexpr int right_size = max_side + 2 * max_disparities + 3 * 64 + right_origin;

    // Of pixel x: of eight in work and of the sixteen before them, rounded up to what divides easily.
    std::uint16_t* keys_of(int x) { return keys_ + x % 32 * candidates; }

    // Keys and winners of the pixels from x on, and in between the sums beside the winners of the eight before:
    // scattered loads and stores beside vector operations. Pixels beyond the row have no keys.
    template <class Keys>
    HWY_INLINE void eight_pixels(const Keys& keys, int x, Right& right, Minima& minima) {
        V index[stride];
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            index[q] = hn::Load(tag_, indices_ + q * lanes);
        }
        const bool padded = range_.count != candidates || x + 8 > width_;
        std::conditional_t<many_registers, Min8<Tag>, EightInMemory<Tag>> min_keys;
        std::conditional_t<many_registers, LastLanesOfEight<Tag>, EightInMemory<Tag>> right_keys;
        DISPARITYD_UNROLL
        for (int i = 0; i < 8; ++i) {
            V key[stride];
            keys(std::min(x + i, width_ - 1), key);
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                key[q] = hn::Add(key[q], index[q]);
            }
            if (padded) {
                const std::uint16_t* padding =
                    x + i < width_ ? padding_ : packed_tables<Tag, stride, bits, bias>.all_padding;
                DISPARITYD_UNROLL
                for (int q = 0; q < stride; ++q) {
                    key[q] = hn::Or(key[q], hn::Load(tag_, padding + q * lanes));
                }
            }
            V least = key[0];
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                least = hn::Min(least, key[q]);
                hn::Store(key[q], tag_, keys_of(x + i) + q * lanes);
            }
            min_keys.add(i, least);
            right_keys.add(i, right.add(key));
            if (x > 0) {
                neighbours(x - 8 + i, minima);
            }
        }
        winners(min_keys.minima(), minima.least + x, minima.winner + x);
        right_winners(right_keys.last_lanes(), x);
    }

    // Of eight pixels.
    HWY_INLINE void winners(V min_by_block, std::int16_t* least, std::int16_t* winner) {
        const hn::FixedTag<std::uint16_t, 8> block;
        hn::Vec<decltype(block)> groups[Groups::count];
        min_of_groups<Groups::count>(tag_, min_by_block, groups);
        hn::Vec<decltype(block)> sum;
        hn::Vec<decltype(block)> candidate;
        first_of_groups<bits, Groups::count, Groups::group_size>(block, groups, &sum, &candidate);
        hn::StoreU(sum, block, reinterpret_cast<std::uint16_t*>(least));
        hn::StoreU(candidate, block, reinterpret_cast<std::uint16_t*>(winner));
    }

    HWY_INLINE void right_winners(V last_lanes, int x) {
        alignas(64) std::uint16_t blocks[lanes];
        hn::Store(last_lanes, tag_, blocks);
        DISPARITYD_UNROLL
        for (int b = 0; b < Groups::blocks; ++b) {
            std::copy_n(blocks + 8 * b, 8, right_row_[b] + right_origin + x);
        }
    }

    HWY_INLINE void neighbours(int x, Minima& minima) {
        take_neighbours(layout_, minima.winner[x], keys_of(x), &minima.minus[x], &minima.plus[x]);
    }

    // Of eight pixels.
    HWY_INLINE void second(int x, Minima& minima) {
        const hn::FixedTag<std::uint16_t, 8> block;
        const std::int16_t* winner = minima.winner + x;
        const auto min_key =
            transpose_min(tag_, [&](int k) { return second_best<stride>(tag_, keys_of(x + k), winner[k]); });
        hn::StoreU(hn::ShiftRight<bits>(min_key), block, reinterpret_cast<std::uint16_t*>(minima.second + x));
    }

    HWY_INLINE void finish_right(const Right& right, std::int16_t* right_winner) {
        std::uint16_t rest[Groups::blocks][Groups::block_size];
        right.rest(rest);
        const int searched = (width_ + 7) / 8 * 8;
        const int first = std::min(0, range_.first);
        const int end = std::max(searched, width_ + range_.first + candidates) + lanes;
        for (int b = 0; b < Groups::blocks; ++b) {
            std::uint16_t* row = right_row_[b] + right_origin;
            std::fill(row + first, row, no_key);
            std::fill(row + searched, row + end, no_key);
            for (int j = 0; j < Groups::block_size; ++j) {
                row[searched - 1 + (Groups::block_size - 1 - j)] = rest[b][j];
            }
        }
        int x = 0;
        for (; x + lanes <= width_; x += lanes) {
            hn::StoreU(right_winners_at(x), words_, right_winner + x);
        }
        if (x < width_) {
            alignas(64) std::int16_t last[lanes];
            hn::Store(right_winners_at(x), words_, last);
            std::copy_n(last, width_ - x, right_winner + x);
        }
    }

    // Where there is no candidate: -1, one less than the first candidate.
    HWY_INLINE auto right_winners_at(int x) const {
        constexpr int blocks_of_group = Groups::blocks / Groups::count;
        V groups[Groups::count];
        DISPARITYD_UNROLL
        for (int b = 0; b < Groups::blocks; ++b) {
            const int at = x + range_.first + Groups::block_size * (b + 1) - 1;
            const V keys = hn::LoadU(tag_, right_row_[b] + right_origin + at);
            V& group = groups[b / blocks_of_group];
            group = b % blocks_of_group == 0 ? keys : hn::Min(group, keys);
        }
        V sum;
        V candidate;
        first_of_groups<bits, Groups::count, Groups::group_size>(tag_, groups, &sum, &candidate);
        const V none = hn::Set(tag_, std::uint16_t{no_key >> bits});
        candidate = hn::IfThenElse(hn::Eq(sum, none), hn::Set(tag_, std::uint16_t{0xffff}), candidate);
        return hn::Add(hn::BitCast(words_, candidate), hn::Set(words_, static_cast<std::int16_t>(range_.first)));
    }

    Tag tag_{};
    hn::RebindToSigned<Tag> words_{};
    int width_;
    DisparityRange range_;
    Layout layout_;
    alignas(64) std::uint16_t indices_[candidates];  // here they are a short way from the other members
    alignas(64) std::uint16_t padding_[candidates];  // no_key at the places past the last candidate, else 0
    alignas(64) std::uint16_t keys_[32 * candidates];
    std::uint16_t right_row_[Groups::blocks][right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
