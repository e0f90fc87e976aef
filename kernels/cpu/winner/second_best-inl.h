// SPDX-License-Identifier: Apache-2.0
// The second best sum of a pixel, S2 of step 7 of docs/algorithm.md: the least of candidates with |k - winner| > 1. The
// uniqueness masks leave the others out.
#if defined(DISPARITYD_CPU_WINNER_SECOND_BEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_SECOND_BEST_INL_H_
#undef DISPARITYD_CPU_WINNER_SECOND_BEST_INL_H_
#else
#define DISPARITYD_CPU_WINNER_SECOND_BEST_INL_H_
#endif

#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/cpu/winner/candidate_layout.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr std::uint16_t no_key = 0xffff;

/// Whether candidate k can be the second best.
constexpr bool competes(int k, int winner) {
    return k < winner - 1 || k > winner + 1;
}

/// The candidates that can be second best to a winner, as masks of the lanes of a residue.
template <int stride, int lanes>
class UniquenessMasks {
public:
    constexpr UniquenessMasks() {
        for (int winner = 0; winner < stride * lanes; ++winner) {
            for (int k = 0; k < stride * lanes; ++k) {
                if (competes(k, winner)) {
                    masks_[winner][k % stride][k / stride / 8] |= static_cast<std::uint8_t>(1 << k / stride % 8);
                }
            }
        }
    }

    constexpr const std::uint8_t* of(int winner, int q) const { return masks_[winner][q]; }

private:
    // Highway may read eight bytes from each mask on.
    std::uint8_t masks_[stride * lanes + 8][stride][(lanes + 7) / 8] = {};
};
template <int stride, int lanes>
inline constexpr UniquenessMasks<stride, lanes> uniqueness_masks;

/// The same as words, residue after residue: 0 for those candidates, no_key for the winner and those beside it.
template <int stride, int lanes>
class UniquenessWords {
public:
    constexpr UniquenessWords() {
        using Layout = CandidateLayout<stride, lanes>;
        for (int winner = 0; winner < Layout::candidates; ++winner) {
            for (int k = 0; k < Layout::candidates; ++k) {
                words_[winner][Layout::of(k)] = competes(k, winner) ? std::uint16_t{0} : no_key;
            }
        }
    }

    constexpr const std::uint16_t* of(int winner) const { return words_[winner]; }

private:
    alignas(64) std::uint16_t words_[stride * lanes][stride * lanes] = {};
};
template <int stride, int lanes>
inline constexpr UniquenessWords<stride, lanes> uniqueness_words;

/// Masks are no vectors, and cheap to look into.
constexpr bool masks_are_bits = HWY_ARCH_X86 != 0 && HWY_TARGET <= HWY_AVX3;

/// How the winner and those beside it are left out of the search.
enum class LeaveOut : std::uint8_t {
    by_mask,   ///< where masks are no vectors
    by_words,  ///< while a table of them leaves room in the first-level cache
    by_store,  ///< of three words: many instructions for one pixel
};
template <int stride, int lanes>
constexpr LeaveOut leave_out = masks_are_bits && (stride <= 4)                    ? LeaveOut::by_mask
                               : CandidateLayout<stride, lanes>::candidates <= 64 ? LeaveOut::by_words
                                                                                  : LeaveOut::by_store;

/// Of the keys of a pixel, residue after residue, what stands beside the winner goes to *minus and *plus; where
/// neither masks nor words do it, these keys and the winner's own become no_key.
template <int stride, int lanes>
HWY_INLINE void take_neighbours(const CandidateLayout<stride, lanes>& layout, int winner, std::uint16_t* keys,
                                std::int16_t* minus, std::int16_t* plus) {
    const std::uint16_t* place = layout.neighbours(winner);
    *minus = static_cast<std::int16_t>(keys[place[0]]);
    *plus = static_cast<std::int16_t>(keys[place[2]]);
    if constexpr (leave_out<stride, lanes> == LeaveOut::by_store) {
        keys[place[0]] = no_key;
        keys[place[1]] = no_key;
        keys[place[2]] = no_key;
    }
}

/// After take_neighbours(): returns the second best key of each lane, of all residues.
template <int stride, class Tag>
HWY_INLINE hn::Vec<Tag> second_best(Tag tag, const std::uint16_t* keys, int winner) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    constexpr LeaveOut how = leave_out<stride, lanes>;
    auto least = hn::Set(tag, no_key);
    DISPARITYD_UNROLL
    for (int q = 0; q < stride; ++q) {
        auto v = hn::Load(tag, keys + q * lanes);
        if constexpr (how == LeaveOut::by_words) {
            v = hn::Or(v, hn::Load(tag, uniqueness_words<stride, lanes>.of(winner) + q * lanes));
        }
        if constexpr (how == LeaveOut::by_mask) {
            const auto mask = hn::LoadMaskBits(tag, uniqueness_masks<stride, lanes>.of(winner, q));
            least = hn::IfThenElse(mask, hn::Min(least, v), least);
        } else {
            least = q == 0 ? v : hn::Min(least, v);
        }
    }
    return least;
}

/// Of `count` keys, their sums; whole vectors are written.
template <int bits>
void sums_of_keys(std::int16_t* keys, int count) {
    const hn::ScalableTag<std::uint16_t> tag;
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
        auto* at = reinterpret_cast<std::uint16_t*>(keys + i);
        hn::Store(hn::ShiftRight<bits>(hn::Load(tag, at)), tag, at);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
