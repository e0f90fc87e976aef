// SPDX-License-Identifier: Apache-2.0
// Step 6 of docs/algorithm.md for one row: winners of both images, and the sums that steps 7 and 12 look at.
//
// Sums are words in classes: class q = 0 .. 2 * registers - 1 holds the candidates 2 * registers * lane + q. (Byte lane
// b of register r is candidate registers * b + r: its even lanes are class r, its odd ones class registers + r.) Two
// bits of a word name its class among those of a part, two to four of them, so that a minimum within a part finds the
// candidate too; between parts names take part in comparisons. Keys are made once, kept for 32 pixels in the
// first-level cache, and minima over all lanes are taken for 8 pixels at a time.
#if defined(DISPARITYD_CPU_WINNER_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_ROW_INL_H_
#undef DISPARITYD_CPU_WINNER_ROW_INL_H_
#else
#define DISPARITYD_CPU_WINNER_ROW_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/least_of_pixels-inl.h"
#include "kernels/cpu/left_results-inl.h"
#include "kernels/cpu/rivals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int name_bits = 2;

/// Sums whose keys are in order, below that of none.
constexpr int largest_sum = (no_key >> name_bits) - 1;

template <int classes>
constexpr int classes_of_part = classes % 4 == 0   ? 4
                                : classes % 3 == 0 ? 3
                                                   : 2;

/// The name of a class in its part.
template <int classes>
constexpr std::uint16_t name_of_class(int q) {
    return static_cast<std::uint16_t>(q % classes_of_part<classes>);
}

/// Of sums that are shifted by `name_bits` already.
template <int classes, class V>
HWY_INLINE V key_of_sum(V shifted_sum, int q) {
    return hn::Or(shifted_sum, hn::Set(hn::DFromV<V>(), name_of_class<classes>(q)));
}

/// In each lane the least sum so far, shifted as in a key, and the candidate that has it.
template <class Tag, int classes>
struct Leader {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr std::uint16_t name_mask = (1 << name_bits) - 1;
    static constexpr std::uint16_t no_sum = no_key & ~name_mask;
    static constexpr std::uint16_t no_candidate = 0xffff;

    /// Of the least keys of part 0.
    explicit HWY_INLINE Leader(V key) : sum(sum_of(key)), candidate(candidate_of(key, 0)) {}
    HWY_INLINE Leader(V least_sum, V its_candidate) : sum(least_sum), candidate(its_candidate) {}

    /// Least keys of a part whose candidates are larger.
    HWY_INLINE void meet(V key, int part) {
        const V least = hn::Min(sum_of(key), sum);
        candidate = hn::IfThenElse(hn::Eq(least, sum), candidate, candidate_of(key, part));
        sum = least;
    }

    V sum;
    V candidate;

private:
    static HWY_INLINE V sum_of(V key) { return hn::AndNot(hn::Set(Tag(), name_mask), key); }
    static HWY_INLINE V candidate_of(V key, int part) {
        using Places = CandidatePlaces<classes, lanes>;
        const hn::RebindToSigned<Tag> numbers;
        const auto first = hn::Load(numbers, Places::numbers.at + part * classes_of_part<classes> * lanes);
        return hn::Add(hn::BitCast(Tag(), first), hn::And(key, hn::Set(Tag(), name_mask)));
    }
};

/// Winners of the right image. A right pixel meets one candidate of each left pixel, the next one at the next pixel:
/// the least key of a part is carried from class to class, what leads after a part waits until the next part is met.
template <class Tag, int classes, int at_once>
class RightWinners {
    using V = hn::Vec<Tag>;
    using Leads = Leader<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int part_classes = classes_of_part<classes>;
    static constexpr int parts = classes / part_classes;

public:
    /// Least keys of parts that are not met as a whole yet, by the class met last.
    struct Partial {
        // Written out: GCC compiles an implicit one for the baseline.
        Partial() {}

        V of[parts][part_classes - 1];
    };

    RightWinners() {
        for (auto& of_part : waiting_) {
            for (int i = 0; i < part_classes; ++i) {
                hn::Store(no_sum(), Tag(), of_part[i].sums);
                hn::Store(no_candidate(), Tag(), of_part[i].candidates);
            }
        }
        DISPARITYD_UNROLL
        for (auto& of_part : partial_.of) {
            std::fill_n(of_part, part_classes - 1, hn::Set(Tag(), no_key));
        }
    }

    Partial partial() const { return partial_; }

    /// Keys of the i-th pixel of a block.
    HWY_INLINE void add(const V* keys, int i, Partial& partial) {
        DISPARITYD_UNROLL
        for (int part = 0; part < parts; ++part) {
            const V* met = keys + part * part_classes;
            V* least = partial.of[part];
            const V of_part = hn::Min(met[part_classes - 1], least[part_classes - 2]);
            DISPARITYD_UNROLL
            for (int q = part_classes - 2; q > 0; --q) {
                least[q] = hn::Min(met[q], least[q - 1]);
            }
            least[0] = met[0];
            Leads leader = before(part, i);
            leader.meet(of_part, part);
            Waiting& waits = waiting_[part][i + part_classes];
            hn::Store(leader.sum, Tag(), waits.sums);
            hn::Store(leader.candidate, Tag(), waits.candidates);
        }
    }

    /// The winners of the right pixels whose candidates are complete with the i-th pixel (which meets them at the last
    /// candidate) and the seven pixels after it, in reverse.
    HWY_INLINE void finished(int i, std::uint16_t* winners) const {
        const hn::FixedTag<std::uint16_t, 8> block;
        const Waiting* waits = waiting_[parts - 1] + part_classes + i;
        const auto last_lanes = [&](int k) { return hn::Load(block, waits[7 - k].candidates + lanes - 8); };
        hn::StoreU(last_lanes_side_by_side(block, last_lanes), block, winners);
    }

    /// After a whole block.
    void next_block(const Partial& partial) {
        partial_ = partial;
        for (auto& of_part : waiting_) {
            DISPARITYD_UNROLL
            for (int i = 0; i < part_classes; ++i) {
                const Waiting& last = of_part[at_once + i];
                hn::Store(hn::Load(Tag(), last.sums), Tag(), of_part[i].sums);
                hn::Store(hn::Load(Tag(), last.candidates), Tag(), of_part[i].candidates);
            }
        }
    }

    /// After the last block, of `count` pixels: the winners of right pixels on the way. Entry k was met at candidate k
    /// by the last pixel.
    void rest(const Partial& partial, int count, std::uint16_t* winners) const {
        for (int part = 0; part < parts; ++part) {
            for (int q = 0; q < part_classes; ++q) {
                alignas(64) std::uint16_t of_lanes[lanes];
                if (q == part_classes - 1) {
                    std::copy_n(waiting_[part][count - 1 + part_classes].candidates, lanes, of_lanes);
                } else {
                    Leads leader = before(part, count - 1 + (part_classes - 1 - q));
                    leader.meet(partial.of[part][q], part);
                    hn::Store(leader.candidate, Tag(), of_lanes);
                }
                for (int lane = 0; lane < lanes; ++lane) {
                    winners[classes * lane + part * part_classes + q] = of_lanes[lane];
                }
            }
        }
    }

private:
    // What leads in each lane after a part, for the pixel that meets the next part.
    struct Waiting {
        alignas(2 * lanes) std::uint16_t sums[lanes];
        alignas(2 * lanes) std::uint16_t candidates[lanes];
    };

    static HWY_INLINE V no_sum() { return hn::Set(Tag(), Leads::no_sum); }
    static HWY_INLINE V no_candidate() { return hn::Set(Tag(), Leads::no_candidate); }

    // What leads before a part that is complete with the i-th pixel. Candidates of a lane follow those of the lane
    // before it; not by a load that is moved by a lane, since that would wait until the stores before it have left the
    // core.
    HWY_INLINE Leads before(int part, int i) const {
        const Waiting& waits = waiting_[(part + parts - 1) % parts][i];
        const V sum = hn::Load(Tag(), waits.sums);
        const V candidate = hn::Load(Tag(), waits.candidates);
        if (part > 0) {
            return {sum, candidate};
        }
        return {from_lane_below(Tag(), sum, no_sum()), from_lane_below(Tag(), candidate, no_candidate())};
    }

    Partial partial_;
    Waiting waiting_[parts][at_once + part_classes];
};

/// `in_one_loop`: keys are searched as they are made, which pays where making them takes little and the registers hold
/// what it needs as well.
template <class Tag, int classes, bool in_one_loop = false>
class WinnerSearch {
    using V = hn::Vec<Tag>;
    using Leads = Leader<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = classes * lanes;
    static constexpr int at_once = 32;
    using Right = RightWinners<Tag, classes, at_once>;

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
            winners(count, minima.least + x, minima.winner + x);
            neighbours(x, count, minima);
            second(count, minima.winner + x, minima.second + x);
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
    HWY_INLINE void take_keys(int i, const V* keys, Right& right, typename Right::Partial& partial) {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            hn::Store(keys[q], tag_, keys_of(i) + q * lanes);
        }
        if constexpr (in_one_loop) {
            least_by_lane(i, keys);
            right.add(keys, i, partial);
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
        Leads leader(least[0]);
        DISPARITYD_UNROLL
        for (int part = 1; part < classes / part_classes; ++part) {
            leader.meet(least[part], part);
        }
        hn::Store(leader.sum, tag_, by_lane_ + i * lanes);
        hn::Store(leader.candidate, tag_, first_ + i * lanes);
    }

    template <class Keys>
    HWY_INLINE void least_and_right(Keys& keys, int x, int count, Right& right) {
        auto partial = right.partial();
        keys(x, count, [&](int i, const V* key) HWY_ATTR {
            if (range_.count == candidates) {
                take_keys(i, key, right, partial);
                return;
            }
            V padded[classes];
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                padded[q] = hn::Or(key[q], hn::Load(tag_, padding_ + q * lanes));
            }
            take_keys(i, padded, right, partial);
        });
        if constexpr (!in_one_loop) {
            for (int i = 0; i < count; ++i) {
                V key[classes];
                DISPARITYD_UNROLL
                for (int q = 0; q < classes; ++q) {
                    key[q] = hn::Load(tag_, keys_of(i) + q * lanes);
                }
                least_by_lane(i, key);
                right.add(key, i, partial);
            }
        }
        // What is written too much is written over later.
        for (int i = 0; i < count; i += 8) {
            right.finished(i, right_row_ + right_entry(x + i + 7, candidates - 1));
        }
        if (x + count < width_) {
            right.next_block(partial);
            return;
        }
        std::uint16_t rest[candidates];
        right.rest(partial, count, rest);
        for (int k = 0; k < candidates; ++k) {
            right_row_[right_entry(width_ - 1, k)] = rest[k];
        }
    }

    // Of each pixel the least sum of all lanes, and the first candidate that has it.
    HWY_INLINE void winners(int count, std::int16_t* least, std::int16_t* winner) {
        const auto none = hn::Set(tag_, Leads::no_candidate);
        for (int i = 0; i < count; i += 8) {
            const auto sums = [&](int k) { return hn::Load(tag_, by_lane_ + (i + k) * lanes); };
            alignas(16) std::uint16_t least_sums[8];
            const auto of_pixels = least_of_pixels(tag_, sums);
            hn::Store(of_pixels, block_, least_sums);
            hn::StoreU(hn::BitCast(words_, hn::ShiftRight<name_bits>(of_pixels)), words_, least + i);
            const auto candidates_found = [&](int k) {
                const auto found = hn::Eq(sums(k), broadcast(tag_, &least_sums[k]));
                return hn::IfThenElse(found, hn::Load(tag_, first_ + (i + k) * lanes), none);
            };
            hn::StoreU(hn::BitCast(words_, least_of_pixels(tag_, candidates_found)), words_, winner + i);
        }
    }

    HWY_INLINE void neighbours(int x, int count, Minima& minima) {
        for (int i = 0; i < count; ++i) {
            take_neighbours(places_, minima.winner[x + i], keys_of(i), &minima.before[x + i], &minima.after[x + i]);
        }
    }

    HWY_INLINE void second(int count, const std::int16_t* winner, std::int16_t* least) {
        for (int i = 0; i < count; i += 8) {
            const auto rivals = [&](int k) { return least_rivals<classes>(tag_, keys_of(i + k), winner[i + k]); };
            const auto keys = least_of_pixels(tag_, rivals);
            hn::StoreU(hn::BitCast(words_, hn::ShiftRight<name_bits>(keys)), words_, least + i);
        }
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
    alignas(64) std::uint16_t by_lane_[at_once * lanes] = {};
    alignas(64) std::uint16_t first_[at_once * lanes] = {};
    std::uint16_t right_row_[right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
