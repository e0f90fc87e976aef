// SPDX-License-Identifier: Apache-2.0
// The second best candidate of a pixel: the least of those that are not beside the winner, |candidate - winner| > 1.
#if defined(DISPARITYD_CPU_RIVALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RIVALS_INL_H_
#undef DISPARITYD_CPU_RIVALS_INL_H_
#else
#define DISPARITYD_CPU_RIVALS_INL_H_
#endif

#include <cstdint>

#include "kernels/cpu/candidate_places.h"
#include "kernels/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr std::uint16_t no_key = 0xffff;

constexpr bool is_rival(int k, int winner) {
    return k < winner - 1 || k > winner + 1;
}

/// The rivals of a winner as masks of the lanes of a class.
template <int classes, int lanes>
class RivalMasks {
public:
    constexpr RivalMasks() {
        for (int winner = 0; winner < classes * lanes; ++winner) {
            for (int k = 0; k < classes * lanes; ++k) {
                if (is_rival(k, winner)) {
                    masks_[winner][k % classes][k / classes / 8] |= static_cast<std::uint8_t>(1 << k / classes % 8);
                }
            }
        }
    }

    constexpr const std::uint8_t* of(int winner, int q) const { return masks_[winner][q]; }

private:
    // Highway may read eight bytes from each mask on.
    std::uint8_t masks_[classes * lanes + 8][classes][(lanes + 7) / 8] = {};
};
template <int classes, int lanes>
inline constexpr RivalMasks<classes, lanes> rival_masks;

/// The same as words, class after class: 0 for a rival, no_key for the winner and those beside it.
template <int classes, int lanes>
class RivalWords {
public:
    constexpr RivalWords() {
        using Places = CandidatePlaces<classes, lanes>;
        for (int winner = 0; winner < Places::candidates; ++winner) {
            for (int k = 0; k < Places::candidates; ++k) {
                words_[winner][Places::of(k)] = is_rival(k, winner) ? std::uint16_t{0} : no_key;
            }
        }
    }

    constexpr const std::uint16_t* of(int winner) const { return words_[winner]; }

private:
    alignas(64) std::uint16_t words_[classes * lanes][classes * lanes] = {};
};
template <int classes, int lanes>
inline constexpr RivalWords<classes, lanes> rival_words;

/// Masks are no vectors, and cheap to look into.
constexpr bool masks_are_bits = HWY_ARCH_X86 != 0 && HWY_TARGET <= HWY_AVX3;

/// How the winner and those beside it are left out of the search.
enum class LeaveOut : std::uint8_t {
    by_mask,   ///< where masks are no vectors
    by_words,  ///< while a table of them leaves room in the first-level cache
    by_store,  ///< of three words: many instructions for one pixel
};
template <int classes, int lanes>
constexpr LeaveOut leave_out = masks_are_bits && (classes <= 4)                    ? LeaveOut::by_mask
                               : CandidatePlaces<classes, lanes>::candidates <= 64 ? LeaveOut::by_words
                                                                                   : LeaveOut::by_store;

/// Of the keys of a pixel, class after class, what stands beside the winner goes to *before and *after; where neither
/// masks nor words do it, these keys and the winner's own become no_key.
template <int classes, int lanes>
HWY_INLINE void take_neighbours(const CandidatePlaces<classes, lanes>& places, int winner, std::uint16_t* keys,
                                std::int16_t* before, std::int16_t* after) {
    const std::uint16_t* place = places.around(winner);
    *before = static_cast<std::int16_t>(keys[place[0]]);
    *after = static_cast<std::int16_t>(keys[place[2]]);
    if constexpr (leave_out<classes, lanes> == LeaveOut::by_store) {
        keys[place[0]] = no_key;
        keys[place[1]] = no_key;
        keys[place[2]] = no_key;
    }
}

/// After take_neighbours(): the least key in each lane of all classes.
template <int classes, class Tag>
HWY_INLINE hn::Vec<Tag> least_rivals(Tag tag, const std::uint16_t* keys, int winner) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    constexpr LeaveOut how = leave_out<classes, lanes>;
    auto least = hn::Set(tag, no_key);
    DISPARITYD_UNROLL
    for (int q = 0; q < classes; ++q) {
        auto v = hn::Load(tag, keys + q * lanes);
        if constexpr (how == LeaveOut::by_words) {
            v = hn::Or(v, hn::Load(tag, rival_words<classes, lanes>.of(winner) + q * lanes));
        }
        if constexpr (how == LeaveOut::by_mask) {
            const auto mask = hn::LoadMaskBits(tag, rival_masks<classes, lanes>.of(winner, q));
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
