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

/// Which candidates of a pixel are not beside a winner, |candidate - winner| > 1, as masks of the lanes of a class.
template <int classes, int lanes>
class Rivals {
public:
    constexpr Rivals() {
        for (int winner = 0; winner < classes * lanes; ++winner) {
            for (int k = 0; k < classes * lanes; ++k) {
                if (k < winner - 1 || k > winner + 1) {
                    masks_[winner][k % classes][k / classes / 8] |= static_cast<std::uint8_t>(1 << k / classes % 8);
                }
            }
        }
    }

    constexpr const std::uint8_t* of(int winner, int q) const { return masks_[winner][q]; }

private:
    std::uint8_t masks_[classes * lanes][classes][(lanes + 7) / 8] = {};
};
template <int classes, int lanes>
inline constexpr Rivals<classes, lanes> rivals;

/// How the winner and those beside it are left out of the search: where masks are no vectors, a few loads in place of
/// stores on which other loads wait.
template <int classes>
constexpr bool rivals_by_mask = (HWY_ARCH_X86 != 0) && (HWY_TARGET <= HWY_AVX3) && (classes <= 2);

/// Of the values of a pixel, class after class, what stands beside the winner goes to *before and *after; where masks
/// do not do it, these values and the winner's own become `none`.
template <int classes, int lanes, class T>
HWY_INLINE void take_neighbours(const CandidatePlaces<classes, lanes>& places, int winner, T none, T* values,
                                std::int16_t* before, std::int16_t* after) {
    const std::uint16_t* place = places.around(winner);
    *before = static_cast<std::int16_t>(values[place[0]]);
    *after = static_cast<std::int16_t>(values[place[2]]);
    if constexpr (!rivals_by_mask<classes>) {
        values[place[0]] = none;
        values[place[1]] = none;
        values[place[2]] = none;
    }
}

/// After take_neighbours(): the least value in each lane of all classes.
template <int classes, class Tag, class T = hn::TFromD<Tag>>
HWY_INLINE hn::Vec<Tag> least_rivals(Tag tag, const T* values, int winner, T none) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    if constexpr (rivals_by_mask<classes>) {
        auto least = hn::Set(tag, none);
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            const auto less = hn::Min(least, hn::Load(tag, values + q * lanes));
            least = hn::IfThenElse(hn::LoadMaskBits(tag, rivals<classes, lanes>.of(winner, q)), less, least);
        }
        return least;
    } else {
        auto least = hn::Load(tag, values);
        DISPARITYD_UNROLL
        for (int q = 1; q < classes; ++q) {
            least = hn::Min(least, hn::Load(tag, values + q * lanes));
        }
        return least;
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
