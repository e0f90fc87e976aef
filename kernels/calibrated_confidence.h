// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace disparityd {

/// Step 13: the chance in 255ths that a disparity of SGM is off by at most 1 px, at the ratios 0, 16, ... 256 of its
/// costs. It was fitted on one half of the evaluation scenes (docs/benchmarks/accuracy.md, "Confidence").
inline constexpr std::array<std::uint8_t, 17> chance_at_ratio{161, 175, 178, 187, 194, 205, 214, 221, 230,
                                                              238, 244, 248, 250, 252, 253, 253, 253};

/// The chance at any ratio: linear between those.
constexpr std::uint8_t calibrated_confidence(std::uint8_t ratio) {
    const int below = ratio / 16;
    const int part = ratio % 16;
    const auto at = [](int i) { return static_cast<int>(chance_at_ratio[static_cast<std::size_t>(i)]); };
    return static_cast<std::uint8_t>((at(below) * (16 - part) + at(below + 1) * part + 8) / 16);
}

}  // namespace disparityd
