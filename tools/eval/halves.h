// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::eval {

/// Two disjoint sets of scenes, so that settings are tuned on one and judged on the other.
struct Halves {
    std::uint32_t seed = 0;
    std::vector<std::string> a;  ///< names in byte order; one more than in b when their number is odd
    std::vector<std::string> b;

    bool in_a(const std::string& scene) const;
};

/// Splits scenes at random. The result depends on the set of names and the seed alone, not on their order, and is the
/// same everywhere: std::shuffle and the standard distributions differ between libraries and are not used.
///
/// The distinct names are sorted by their bytes, then shuffled (Fisher and Yates): for i from the last index to 1, swap
/// elements i and j. j is uniform in 0 .. i: the next number r of std::mt19937(seed) modulo i + 1, where an r of at
/// least the largest multiple of i + 1 up to 2^32 is skipped. `a` gets the first half of the result.
///
/// Throws std::invalid_argument for fewer than two names.
Halves split_in_halves(std::vector<std::string> scenes, std::uint32_t seed);

}  // namespace disparityd::eval
