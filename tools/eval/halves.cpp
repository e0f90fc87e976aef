// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/halves.h"

#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>

namespace disparityd::eval {
namespace {

/// Returns a uniform number in 0 .. count - 1.
std::size_t uniform_below(std::size_t count, std::mt19937& random) {
    constexpr std::uint64_t numbers = std::uint64_t{1} << 32;
    const std::uint64_t fair = numbers - numbers % count;
    std::uint64_t drawn = random();
    while (drawn >= fair) {
        drawn = random();
    }
    return static_cast<std::size_t>(drawn % count);
}

}  // namespace

bool Halves::in_a(const std::string& scene) const {
    return std::binary_search(a.begin(), a.end(), scene);
}

Halves split_in_halves(std::vector<std::string> scenes, std::uint32_t seed) {
    std::sort(scenes.begin(), scenes.end());
    scenes.erase(std::unique(scenes.begin(), scenes.end()), scenes.end());
    if (scenes.size() < 2) {
        throw std::invalid_argument("--halves: found " + std::to_string(scenes.size()) +
                                    " scene in DATA, allowed: at least 2 with different names");
    }
    std::mt19937 random(seed);
    for (std::size_t i = scenes.size() - 1; i > 0; --i) {
        std::swap(scenes[i], scenes[uniform_below(i + 1, random)]);
    }
    const auto middle = scenes.begin() + static_cast<std::ptrdiff_t>((scenes.size() + 1) / 2);
    std::sort(scenes.begin(), middle);
    std::sort(middle, scenes.end());
    return {seed, {scenes.begin(), middle}, {middle, scenes.end()}};
}

}  // namespace disparityd::eval
