// SPDX-License-Identifier: Apache-2.0
// Keys of sums of words, and the running minimum of each lane with its candidate.
//
// Sums lie by residue, see match_layout.h. A residue group is two to four residues that follow each other. The lowest
// two bits of a key are the index of its residue in its group, so that a minimum within a group finds the candidate
// too. Between groups the candidates are compared and chosen beside the sums.
#if defined(DISPARITYD_CPU_WINNER_RUNNING_ARGMIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_RUNNING_ARGMIN_INL_H_
#undef DISPARITYD_CPU_WINNER_RUNNING_ARGMIN_INL_H_
#else
#define DISPARITYD_CPU_WINNER_RUNNING_ARGMIN_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/winner/candidate_layout.h"
#include "kernels/cpu/winner/second_best-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int index_bits = 2;
constexpr std::uint16_t index_mask = (1 << index_bits) - 1;

/// Sums whose keys are in order, below that of none.
constexpr int largest_sum = (no_key >> index_bits) - 1;

/// How the residues are grouped: evenly, or the first groups have one more than the last.
template <int stride>
struct ResidueGroups {
    static constexpr int count = (stride + 3) / 4;
    static constexpr int largest = (stride + count - 1) / count;

    static constexpr int begin(int group) { return group * (stride / count) + std::min(group, stride % count); }
    static constexpr int size(int group) { return begin(group + 1) - begin(group); }
    static constexpr int of(int q) {
        int group = 0;
        while (begin(group + 1) <= q) {
            ++group;
        }
        return group;
    }
};

/// Returns the index of a residue in its group.
template <int stride>
constexpr std::uint16_t index_of_residue(int q) {
    return static_cast<std::uint16_t>(q - ResidueGroups<stride>::begin(ResidueGroups<stride>::of(q)));
}

/// Of sums that are shifted by `index_bits` already.
template <int stride, class V>
HWY_INLINE V key_of_sum(V shifted_sum, int q) {
    return hn::Or(shifted_sum, hn::Set(hn::DFromV<V>(), index_of_residue<stride>(q)));
}

/// Shifted as in the key.
template <class V>
HWY_INLINE V sum_of_key(V key) {
    return hn::AndNot(hn::Set(hn::DFromV<V>(), index_mask), key);
}

/// In each lane the least sum so far, shifted as in a key, and the first candidate that has it.
template <class Tag, int stride>
struct RunningArgmin {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr std::uint16_t no_sum = no_key & ~index_mask;
    static constexpr std::uint16_t no_candidate = 0xffff;

    /// Starts with the least keys of group 0.
    explicit HWY_INLINE RunningArgmin(V key) : sum(sum_of_key(key)), candidate(candidate_of(key, 0)) {}
    HWY_INLINE RunningArgmin(V min_sum, V its_candidate) : sum(min_sum), candidate(its_candidate) {}

    /// Takes the least keys of a later group into account.
    HWY_INLINE void update(V key, int group) {
        const V least = hn::Min(sum_of_key(key), sum);
        candidate = hn::IfThenElse(hn::Eq(least, sum), candidate, candidate_of(key, group));
        sum = least;
    }

    /// Moves the minima after the last group up by a lane: candidates of a lane follow those of the lane below.
    static HWY_INLINE RunningArgmin from_lane_below(V sum, V candidate) {
        return {from_lane_below_or_all(Tag(), sum, hn::Set(Tag(), no_sum)),
                from_lane_below_or_all(Tag(), candidate, hn::Set(Tag(), no_candidate))};
    }

    V sum;
    V candidate;

private:
    static HWY_INLINE V candidate_of(V key, int group) {
        using Layout = CandidateLayout<stride, lanes>;
        const hn::RebindToSigned<Tag> numbers;
        const auto first = hn::Load(numbers, Layout::numbers.at + ResidueGroups<stride>::begin(group) * lanes);
        return hn::Add(hn::BitCast(Tag(), first), hn::And(key, hn::Set(Tag(), index_mask)));
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
