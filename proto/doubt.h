// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

/// Why a frame, or a sector of an obstacle scan, can be trusted less than others, and what people are told of it. Step
/// 15 of docs/algorithm.md says how doubts are found.
namespace disparityd::proto {

/// Bits of Frame.flags, with the numbers of FrameFlags.
enum Doubt : std::uint32_t {
    doubt_dark = 1U << 8U,
    doubt_saturated = 1U << 9U,
    doubt_blurred = 1U << 10U,
    doubt_dirty_eye = 1U << 11U,
    doubt_covered_eye = 1U << 12U,
    doubt_misaligned = 1U << 13U,
    doubt_too_near = 1U << 14U,
    doubt_noisy = 1U << 15U,
};

/// Those that a sector of an obstacle scan may have: the others are of a whole eye or pair.
inline constexpr std::uint32_t sector_doubts = doubt_dark | doubt_saturated | doubt_dirty_eye | doubt_too_near;

/// Where the trust in a frame stands in Frame.flags: 1 .. 255, more is better; 0 = not told.
inline constexpr unsigned trust_shift = 24;

struct DoubtFacts {
    Doubt bit;
    std::string_view name;     ///< one word for programs, "covered-eye"
    std::string_view meaning;  ///< for people, without a full stop
    std::string_view remedy;   ///< what to do, the same
    bool alarm;                ///< somebody must mend it: it is told as an alarm
    int trust_left;            ///< what it leaves of the trust, in sixteenths
};

inline constexpr std::array doubts{
    DoubtFacts{doubt_dark, "dark", "both eyes see hardly any light", "give light, or a longer exposure", false, 8},
    DoubtFacts{doubt_saturated, "saturated", "much of a picture is white", "shorten the exposure", false, 12},
    DoubtFacts{doubt_blurred, "blurred", "one eye sees less sharply than the other",
               "clean its lens, look for condensation, or focus it", true, 8},
    DoubtFacts{doubt_dirty_eye, "dirty-eye", "a part of one eye stays dull where the other eye sees texture",
               "clean its lens, and the window in front of it", true, 8},
    DoubtFacts{doubt_covered_eye, "covered-eye", "one eye sees nothing where the other sees texture",
               "uncover it, or look for a failed image sensor", true, 1},
    DoubtFacts{doubt_misaligned, "misaligned", "the rows of both eyes do not fit",
               "switch [self_calibration] on, or calibrate the camera anew", true, 6},
    DoubtFacts{doubt_too_near, "too-near", "something may be nearer than can be measured", "back off", false, 12},
    DoubtFacts{doubt_noisy, "noisy", "the picture has so much noise that it was matched for that",
               "give light, or a smaller gain", false, 12},
};

/// Returns the trust of step 15 in a frame, or in a part of one, of which so many 255ths are measured: all of it where
/// three fifths are, less by each doubt, and 1 at least.
constexpr std::uint8_t trust_in(int measured, std::uint32_t flags) {
    constexpr int enough = 153;
    int trust = 255 * (measured < enough ? measured : enough) / enough;
    for (const DoubtFacts& doubt : doubts) {
        trust = (flags & doubt.bit) != 0 ? trust * doubt.trust_left / 16 : trust;
    }
    return static_cast<std::uint8_t>(trust > 1 ? trust : 1);
}

/// Returns the words of the doubts of a frame, with spaces between them.
inline std::string doubt_names(std::uint32_t flags) {
    std::string names;
    for (const DoubtFacts& doubt : doubts) {
        if ((flags & doubt.bit) != 0) {
            names += names.empty() ? "" : " ";
            names += doubt.name;
        }
    }
    return names;
}

}  // namespace disparityd::proto
