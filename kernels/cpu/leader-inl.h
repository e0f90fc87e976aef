// SPDX-License-Identifier: Apache-2.0
// Keys of sums of words, and what leads among them in each lane.
//
// Sums are words in classes: class q = 0 .. 2 * registers - 1 holds the candidates 2 * registers * lane + q. (Byte lane
// b of register r is candidate registers * b + r: its even lanes are class r, its odd ones class registers + r.) Two
// bits of a word name its class among those of a part, two to four of them, so that a minimum within a part finds the
// candidate too; between parts names take part in comparisons.
#if defined(DISPARITYD_CPU_LEADER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_LEADER_INL_H_
#undef DISPARITYD_CPU_LEADER_INL_H_
#else
#define DISPARITYD_CPU_LEADER_INL_H_
#endif

#include "kernels/cpu/candidate_places.h"
#include "kernels/cpu/rivals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int name_bits = 2;
constexpr std::uint16_t name_mask = (1 << name_bits) - 1;

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

/// Shifted as in the key.
template <class V>
HWY_INLINE V sum_of_key(V key) {
    return hn::AndNot(hn::Set(hn::DFromV<V>(), name_mask), key);
}

/// In each lane the least sum so far, shifted as in a key, and the candidate that has it.
template <class Tag, int classes>
struct Leader {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr std::uint16_t no_sum = no_key & ~name_mask;
    static constexpr std::uint16_t no_candidate = 0xffff;

    /// Of the least keys of part 0.
    explicit HWY_INLINE Leader(V key) : sum(sum_of_key(key)), candidate(candidate_of(key, 0)) {}
    HWY_INLINE Leader(V least_sum, V its_candidate) : sum(least_sum), candidate(its_candidate) {}

    /// Least keys of a part whose candidates are larger.
    HWY_INLINE void meet(V key, int part) {
        const V least = hn::Min(sum_of_key(key), sum);
        candidate = hn::IfThenElse(hn::Eq(least, sum), candidate, candidate_of(key, part));
        sum = least;
    }

    /// Of what leads after the last part: candidates of a lane follow those of the lane before it.
    static HWY_INLINE Leader from_lane_below(V sum, V candidate) {
        return {from_lane_below_or_all(Tag(), sum, hn::Set(Tag(), no_sum)),
                from_lane_below_or_all(Tag(), candidate, hn::Set(Tag(), no_candidate))};
    }

    V sum;
    V candidate;

private:
    static HWY_INLINE V candidate_of(V key, int part) {
        using Places = CandidatePlaces<classes, lanes>;
        const hn::RebindToSigned<Tag> numbers;
        const auto first = hn::Load(numbers, Places::numbers.at + part * classes_of_part<classes> * lanes);
        return hn::Add(hn::BitCast(Tag(), first), hn::And(key, hn::Set(Tag(), name_mask)));
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
