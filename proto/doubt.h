// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

/// Why a frame can be trusted less than others, and what people are told of it. Step 15 of docs/algorithm.md says how
/// doubts are found.
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

/// Where the trust in a frame stands in Frame.flags: 1 .. 255, more is better; 0 = not told.
inline constexpr unsigned trust_shift = 24;

struct DoubtFacts {
    Doubt bit;
    std::string_view name;     ///< one word for programs, "covered-eye"
    std::string_view meaning;  ///< for people, without a full stop
    std::string_view remedy;   ///< what to do, the same
    bool alarm;                ///< somebody must mend it: it is told as an alarm
};

inline constexpr std::array doubts{
    DoubtFacts{doubt_dark, "dark", "both eyes see hardly any light", "give light, or a longer exposure", false},
    DoubtFacts{doubt_saturated, "saturated", "much of a picture is white", "shorten the exposure", false},
    DoubtFacts{doubt_blurred, "blurred", "one eye sees less sharply than the other",
               "clean its lens, look for condensation, or focus it", true},
    DoubtFacts{doubt_dirty_eye, "dirty-eye", "a part of one eye stays dull where the other eye sees texture",
               "clean its lens, and the window in front of it", true},
    DoubtFacts{doubt_covered_eye, "covered-eye", "one eye sees nothing where the other sees texture",
               "uncover it, or look for a failed image sensor", true},
    DoubtFacts{doubt_misaligned, "misaligned", "the rows of both eyes do not fit",
               "switch [self_calibration] on, or calibrate the camera anew", true},
    DoubtFacts{doubt_too_near, "too-near", "something may be nearer than can be measured", "back off", false},
    DoubtFacts{doubt_noisy, "noisy", "the picture has so much noise that it was matched for that",
               "give light, or a smaller gain", false},
};

/// Returns the words of the doubts of a frame, with spaces between them.
inline std::string doubt_names(std::uint32_t flags) {
    std::string names;
    for (const DoubtFacts& doubt : doubts) {
        if ((flags & doubt.bit) != 0) {
            names += (names.empty() ? "" : " ") + std::string(doubt.name);
        }
    }
    return names;
}

}  // namespace disparityd::proto
