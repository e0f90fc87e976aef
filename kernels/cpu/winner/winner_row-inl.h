// SPDX-License-Identifier: Apache-2.0
// Step 6 of docs/algorithm.md for one row: winners of both images, and the sums that steps 7 and 13 look at.
//
// Keys of running_argmin-inl.h are made once and kept for 32 pixels in the first-level cache. Minima over all lanes are
// taken for 8 pixels at a time.
#if defined(DISPARITYD_CPU_WINNER_WINNER_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_WINNER_ROW_INL_H_
#undef DISPARITYD_CPU_WINNER_WINNER_ROW_INL_H_
#else
#define DISPARITYD_CPU_WINNER_WINNER_ROW_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/simd/transpose_min-inl.h"
#include "kernels/cpu/winner/left_results-inl.h"
#include "kernels/cpu/winner/right_winners-inl.h"
#include "kernels/cpu/winner/running_argmin-inl.h"
#include "kernels/cpu/winner/second_best-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// `in_one_loop`: keys are searched as they are made, which pays where making them takes little and the registers hold
/// what it needs as well.
template <class Tag, int stride, bool in_one_loop = false>
class WinnerSearch {
    using V = hn::Vec<Tag>;
    using Argmin = RunningArgmin<Tag, stride>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = stride * lanes;
    static constexpr int at_once = 32;
    using Groups = ResidueGroups<stride>;
    static constexpr bool one_group = Groups::count == 1;
    // The winner's lane is looked for in the bits of a comparison, and its key has the index of the residue.
    static constexpr bool by_lane = one_group && masks_are_bits;
    using Right =
        std::conditional_t<one_group && in_one_loop && many_registers, RightWinnersInRegisters<Tag, stride, at_once>,
                           RightWinnersInMemory<Tag, stride, at_once>>;

public:
    explicit WinnerSearch(const MatchGeometry& geometry)
        : width_(geometry.width), range_(geometry.range), layout_(range_.count) {
        for (int k = 0; k < candidates && range_.count != candidates; ++k) {
            padding_[Layout::of(k)] = k < range_.count ? std::uint16_t{0} : no_key;
        }
    }

    /// keys(x, count, take) calls take(i, const V* keys) with those of pixel x + i for i = 0 .. count - 1, one after
    /// the other; it is asked for each pixel once, from left to right.
    template <class Keys>
    void run(Keys keys, Minima& minima, std::int16_t* right_winner) {
        std::fill_n(right_row_ + right_origin, width_, Argmin::no_candidate);
        Right right;
        for (int x = 0; x < width_; x += at_once) {
            const int count = std::min(at_once, width_ - x);
            min_and_right(keys, x, count, right);
            std::fill(keys_of(count), keys_of((count + 7) / 8 * 8), std::uint16_t{0});  // searched in eights
            search_keys(x, count, minima);
        }
        sums_of_keys<index_bits>(minima.minus, width_);
        sums_of_keys<index_bits>(minima.plus, width_);
        finish_right(right_winner);
    }

private:
    using Layout = CandidateLayout<stride, lanes>;

    // Right pixels, backwards from beyond the right end of the image to left of it, so that nothing needs to ask where
    // one is.
    static constexpr int right_origin = 2 * max_disparities;
    static constexpr int right_size = max_side + 4 * max_disparities;

    std::uint16_t* keys_of(int i) { return keys_ + i * candidates; }

    // The right pixel that is candidate k of left pixel x, as an index of right_row_.
    int right_entry(int x, int k) const { return right_origin + width_ - 1 - (x - range_.first - k); }

    // Of the i-th pixel of a block.
    HWY_INLINE void take_keys(int i, const V* keys, Right& right, typename Right::State& state) {
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            hn::Store(keys[q], tag_, keys_of(i) + q * lanes);
        }
        if constexpr (in_one_loop) {
            min_by_lane(i, keys);
            right.add(keys, i, state);
        }
    }

    HWY_INLINE void min_by_lane(int i, const V* keys) {
        V least[Groups::count];
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            V& of_group = least[Groups::of(q)];
            of_group = index_of_residue<stride>(q) == 0 ? keys[q] : hn::Min(of_group, keys[q]);
        }
        if constexpr (one_group) {
            hn::Store(least[0], tag_, least_ + i * lanes);
            return;
        }
        Argmin argmin(least[0]);
        DISPARITYD_UNROLL
        for (int group = 1; group < Groups::count; ++group) {
            argmin.update(least[group], group);
        }
        hn::Store(argmin.sum, tag_, least_ + i * lanes);
        hn::Store(argmin.candidate, tag_, first_ + i * lanes);
    }

    template <class Keys>
    HWY_INLINE void min_and_right(Keys& keys, int x, int count, Right& right) {
        auto state = right.state();
        keys(x, count, [&](int i, const V* key) HWY_ATTR {
            if (range_.count == candidates) {
                take_keys(i, key, right, state);
                return;
            }
            V padded[stride];
            DISPARITYD_UNROLL
            for (int q = 0; q < stride; ++q) {
                padded[q] = hn::Or(key[q], hn::Load(tag_, padding_ + q * lanes));
            }
            take_keys(i, padded, right, state);
        });
        if constexpr (!in_one_loop) {
            for (int i = 0; i < count; ++i) {
                V key[stride];
                DISPARITYD_UNROLL
                for (int q = 0; q < stride; ++q) {
                    key[q] = hn::Load(tag_, keys_of(i) + q * lanes);
                }
                min_by_lane(i, key);
                right.add(key, i, state);
            }
        }
        right.keep(state);
        // What is written too much is written over later.
        for (int i = 0; i < count; i += 8) {
            right.finished(i, right_row_ + right_entry(x + i + 7, candidates - 1));
        }
        if (x + count < width_) {
            right.next_block();
            return;
        }
        std::uint16_t rest[candidates];
        right.rest(count, rest);
        for (int k = 0; k < candidates; ++k) {
            right_row_[right_entry(width_ - 1, k)] = rest[k];
        }
    }

    // Eights one after the other where their keys stay as they are, a step of one beside later steps of those before
    // it: its own steps wait for each other.
    HWY_INLINE void search_keys(int x, int count, Minima& minima) {
        if constexpr (leave_out<stride, lanes> == LeaveOut::by_store) {
            for (int i = 0; i < count; i += 8) {
                min_sums(x, i, minima);
            }
            for (int i = 0; i < count; i += 8) {
                winners(x, i, minima);
            }
            neighbours(x, 0, count, minima);
            for (int i = 0; i < count; i += 8) {
                second(x, i, minima);
            }
        } else {
            for (int i = 0; i < count + 16; i += 8) {
                if (i < count) {
                    min_sums(x, i, minima);
                }
                if (i >= 8 && i - 8 < count) {
                    winners(x, i - 8, minima);
                }
                if (i >= 16) {
                    neighbours(x, i - 16, std::min(i - 8, count), minima);
                    second(x, i - 16, minima);
                }
            }
        }
    }

    // Of the eight pixels from the i-th of the block at x on, of all lanes.
    HWY_INLINE void min_sums(int x, int i, Minima& minima) {
        const auto sums = sum_of_key(transpose_min(tag_, [&](int k) { return min_of_lanes(i + k); }));
        if constexpr (by_lane) {
            hn::Store(hn::Add(sums, hn::Set(block_, std::uint16_t{index_mask + 1})), block_, min_sums_ + i);
        } else {
            hn::Store(sums, block_, min_sums_ + i);
        }
        hn::StoreU(hn::BitCast(words_, hn::ShiftRight<index_bits>(sums)), words_, minima.least + x + i);
    }

    HWY_INLINE V min_of_lanes(int i) const { return hn::Load(tag_, least_ + i * lanes); }

    // After min_sums(): the first candidates that have them.
    HWY_INLINE void winners(int x, int i, Minima& minima) {
        if constexpr (by_lane) {
            DISPARITYD_UNROLL
            for (int k = i; k < i + 8; ++k) {
                const auto found = hn::Lt(min_of_lanes(k), broadcast(tag_, &min_sums_[k]));
                const std::size_t lane = hn::FindKnownFirstTrue(tag_, found);
                const unsigned index = least_[static_cast<std::size_t>(k) * lanes + lane] & index_mask;
                minima.winner[x + k] = static_cast<std::int16_t>(stride * lane + index);
            }
        } else {
            const V none = hn::Set(tag_, Argmin::no_candidate);
            const auto candidates_found = [&](int k) HWY_ATTR {
                const V least = min_of_lanes(i + k);
                const Argmin argmin =
                    one_group ? Argmin(least) : Argmin(least, hn::Load(tag_, first_ + (i + k) * lanes));
                const auto found = hn::Eq(argmin.sum, broadcast(tag_, &min_sums_[i + k]));
                return hn::IfThenElse(found, argmin.candidate, none);
            };
            hn::StoreU(hn::BitCast(words_, transpose_min(tag_, candidates_found)), words_, minima.winner + x + i);
        }
    }

    HWY_INLINE void neighbours(int x, int first, int end, Minima& minima) {
        for (int i = first; i < end; ++i) {
            take_neighbours(layout_, minima.winner[x + i], keys_of(i), &minima.minus[x + i], &minima.plus[x + i]);
        }
    }

    HWY_INLINE void second(int x, int i, Minima& minima) {
        const std::int16_t* winner = minima.winner + x + i;
        const auto second_bests = [&](int k) { return second_best<stride>(tag_, keys_of(i + k), winner[k]); };
        const auto keys = transpose_min(tag_, second_bests);
        hn::StoreU(hn::BitCast(words_, hn::ShiftRight<index_bits>(keys)), words_, minima.second + x + i);
    }

    void finish_right(std::int16_t* right_winner) const {
        const std::uint16_t* found = right_row_ + right_origin + width_ - 1;
        for (int i = 0; i < width_; ++i) {
            // Where there is no candidate: -1, one less than the first candidate.
            right_winner[i] = static_cast<std::int16_t>(found[-i] + range_.first);
        }
    }

    Tag tag_{};
    hn::FixedTag<std::uint16_t, 8> block_{};
    hn::FixedTag<std::int16_t, 8> words_{};
    int width_;
    DisparityRange range_;
    Layout layout_;
    alignas(64) std::uint16_t padding_[candidates];
    alignas(64) std::uint16_t keys_[at_once * candidates];
    alignas(64) std::uint16_t least_[at_once * lanes] = {};  // of one group: keys; else sums, and in first_ candidates
    alignas(64) std::uint16_t first_[at_once * lanes] = {};
    // Of pixels on their way, as in keys; `by_lane` the next larger ones.
    alignas(16) std::uint16_t min_sums_[at_once];
    std::uint16_t right_row_[right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
