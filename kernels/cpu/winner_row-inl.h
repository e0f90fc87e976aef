// SPDX-License-Identifier: Apache-2.0
// Step 6 of docs/algorithm.md for one row: winners of both images, and the sums that steps 7 and 12 look at.
//
// Keys of leader-inl.h are made once, kept for 32 pixels in the first-level cache, and minima over all lanes are taken
// for 8 pixels at a time.
#if defined(DISPARITYD_CPU_WINNER_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_ROW_INL_H_
#undef DISPARITYD_CPU_WINNER_ROW_INL_H_
#else
#define DISPARITYD_CPU_WINNER_ROW_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/leader-inl.h"
#include "kernels/cpu/least_of_pixels-inl.h"
#include "kernels/cpu/left_results-inl.h"
#include "kernels/cpu/right_winners-inl.h"
#include "kernels/cpu/rivals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// `in_one_loop`: keys are searched as they are made, which pays where making them takes little and the registers hold
/// what it needs as well.
template <class Tag, int classes, bool in_one_loop = false>
class WinnerSearch {
    using V = hn::Vec<Tag>;
    using Leads = Leader<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = classes * lanes;
    static constexpr int at_once = 32;
    static constexpr bool one_part = classes_of_part<classes> == classes;
    // The winner's lane is looked for in the bits of a comparison, and its key names the class.
    static constexpr bool by_lane = one_part && masks_are_bits;
    using Right =
        std::conditional_t<one_part && in_one_loop && many_registers, RightWinnersInRegisters<Tag, classes, at_once>,
                           RightWinnersInMemory<Tag, classes, at_once>>;

public:
    explicit WinnerSearch(const SgmGeometry& geometry)
        : width_(geometry.width), range_(geometry.range), places_(range_.count) {
        for (int k = 0; k < candidates && range_.count != candidates; ++k) {
            padding_[Places::of(k)] = k < range_.count ? std::uint16_t{0} : no_key;
        }
    }

    /// keys(x, count, take) calls take(i, const V* keys) with those of pixel x + i for i = 0 .. count - 1, one after
    /// the other; it is asked for each pixel once, from left to right.
    template <class Keys>
    void run(Keys keys, Minima& minima, std::int16_t* right_winner) {
        std::fill_n(right_row_ + right_origin, width_, Leads::no_candidate);
        Right right;
        for (int x = 0; x < width_; x += at_once) {
            const int count = std::min(at_once, width_ - x);
            least_and_right(keys, x, count, right);
            std::fill(keys_of(count), keys_of((count + 7) / 8 * 8), std::uint16_t{0});  // searched in eights
            search_keys(x, count, minima);
        }
        sums_of_keys<name_bits>(minima.before, width_);
        sums_of_keys<name_bits>(minima.after, width_);
        finish_right(right_winner);
    }

private:
    using Places = CandidatePlaces<classes, lanes>;

    // Right pixels, backwards from beyond the right end of the image to left of it, so that nothing needs to ask where
    // one is.
    static constexpr int right_origin = 2 * max_disparities;
    static constexpr int right_size = max_side + 4 * max_disparities;

    std::uint16_t* keys_of(int i) { return keys_ + i * candidates; }

    // The right pixel that left pixel x meets at candidate k, as an index of right_row_.
    int right_entry(int x, int k) const { return right_origin + width_ - 1 - (x - range_.first - k); }

    // Of the i-th pixel of a block.
    HWY_INLINE void take_keys(int i, const V* keys, Right& right, typename Right::State& state) {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            hn::Store(keys[q], tag_, keys_of(i) + q * lanes);
        }
        if constexpr (in_one_loop) {
            least_by_lane(i, keys);
            right.add(keys, i, state);
        }
    }

    HWY_INLINE void least_by_lane(int i, const V* keys) {
        constexpr int part_classes = classes_of_part<classes>;
        V least[classes / part_classes];
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            V& of_part = least[q / part_classes];
            of_part = q % part_classes == 0 ? keys[q] : hn::Min(of_part, keys[q]);
        }
        if constexpr (one_part) {
            hn::Store(least[0], tag_, least_ + i * lanes);
            return;
        }
        Leads leader(least[0]);
        DISPARITYD_UNROLL
        for (int part = 1; part < classes / part_classes; ++part) {
            leader.meet(least[part], part);
        }
        hn::Store(leader.sum, tag_, least_ + i * lanes);
        hn::Store(leader.candidate, tag_, first_ + i * lanes);
    }

    template <class Keys>
    HWY_INLINE void least_and_right(Keys& keys, int x, int count, Right& right) {
        auto state = right.state();
        keys(x, count, [&](int i, const V* key) HWY_ATTR {
            if (range_.count == candidates) {
                take_keys(i, key, right, state);
                return;
            }
            V padded[classes];
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                padded[q] = hn::Or(key[q], hn::Load(tag_, padding_ + q * lanes));
            }
            take_keys(i, padded, right, state);
        });
        if constexpr (!in_one_loop) {
            for (int i = 0; i < count; ++i) {
                V key[classes];
                DISPARITYD_UNROLL
                for (int q = 0; q < classes; ++q) {
                    key[q] = hn::Load(tag_, keys_of(i) + q * lanes);
                }
                least_by_lane(i, key);
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
        if constexpr (leave_out<classes, lanes> == LeaveOut::by_store) {
            for (int i = 0; i < count; i += 8) {
                least_sums(x, i, minima);
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
                    least_sums(x, i, minima);
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
    HWY_INLINE void least_sums(int x, int i, Minima& minima) {
        const auto sums = sum_of_key(least_of_pixels(tag_, [&](int k) { return least_of_lanes(i + k); }));
        if constexpr (by_lane) {
            hn::Store(hn::Add(sums, hn::Set(block_, std::uint16_t{name_mask + 1})), block_, least_sums_ + i);
        } else {
            hn::Store(sums, block_, least_sums_ + i);
        }
        hn::StoreU(hn::BitCast(words_, hn::ShiftRight<name_bits>(sums)), words_, minima.least + x + i);
    }

    HWY_INLINE V least_of_lanes(int i) const { return hn::Load(tag_, least_ + i * lanes); }

    // After least_sums(): the first candidates that have them.
    HWY_INLINE void winners(int x, int i, Minima& minima) {
        if constexpr (by_lane) {
            DISPARITYD_UNROLL
            for (int k = i; k < i + 8; ++k) {
                const auto found = hn::Lt(least_of_lanes(k), broadcast(tag_, &least_sums_[k]));
                const std::size_t lane = hn::FindKnownFirstTrue(tag_, found);
                const unsigned name = least_[static_cast<std::size_t>(k) * lanes + lane] & name_mask;
                minima.winner[x + k] = static_cast<std::int16_t>(classes * lane + name);
            }
        } else {
            const V none = hn::Set(tag_, Leads::no_candidate);
            const auto candidates_found = [&](int k) HWY_ATTR {
                const V least = least_of_lanes(i + k);
                const Leads leader = one_part ? Leads(least) : Leads(least, hn::Load(tag_, first_ + (i + k) * lanes));
                const auto found = hn::Eq(leader.sum, broadcast(tag_, &least_sums_[i + k]));
                return hn::IfThenElse(found, leader.candidate, none);
            };
            hn::StoreU(hn::BitCast(words_, least_of_pixels(tag_, candidates_found)), words_, minima.winner + x + i);
        }
    }

    HWY_INLINE void neighbours(int x, int first, int end, Minima& minima) {
        for (int i = first; i < end; ++i) {
            take_neighbours(places_, minima.winner[x + i], keys_of(i), &minima.before[x + i], &minima.after[x + i]);
        }
    }

    HWY_INLINE void second(int x, int i, Minima& minima) {
        const std::int16_t* winner = minima.winner + x + i;
        const auto rivals = [&](int k) { return least_rivals<classes>(tag_, keys_of(i + k), winner[k]); };
        const auto keys = least_of_pixels(tag_, rivals);
        hn::StoreU(hn::BitCast(words_, hn::ShiftRight<name_bits>(keys)), words_, minima.second + x + i);
    }

    void finish_right(std::int16_t* right_winner) const {
        const std::uint16_t* found = right_row_ + right_origin + width_ - 1;
        for (int i = 0; i < width_; ++i) {
            // Where no candidate was met: -1, one less than the first candidate.
            right_winner[i] = static_cast<std::int16_t>(found[-i] + range_.first);
        }
    }

    Tag tag_{};
    hn::FixedTag<std::uint16_t, 8> block_{};
    hn::FixedTag<std::int16_t, 8> words_{};
    int width_;
    DisparityRange range_;
    Places places_;
    alignas(64) std::uint16_t padding_[candidates];
    alignas(64) std::uint16_t keys_[at_once * candidates];
    alignas(64) std::uint16_t least_[at_once * lanes] = {};  // of one part: keys; else sums, and in first_ candidates
    alignas(64) std::uint16_t first_[at_once * lanes] = {};
    // Of pixels on their way, as in keys; `by_lane` the next larger ones.
    alignas(16) std::uint16_t least_sums_[at_once];
    std::uint16_t right_row_[right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
