// SPDX-License-Identifier: Apache-2.0
#include "lab/paper/as_described.h"

#include <algorithm>
#include <cstdlib>

#include "tools/bench/naive.h"

namespace disparityd::lab {
namespace {

constexpr int radius_x = 4;
constexpr int radius_y = 3;
constexpr std::uint16_t sad_outside = 9 * 7 * 255;
constexpr std::uint8_t census_outside = 62;

template <typename T>
T replicated(Plane<const T> image, int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
}

// The image of absolute differences has its own border replicated, not the two images.
std::uint16_t window_sum(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, int x, int y, int d) {
    int sum = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            const int column = std::clamp(x + dx, 0, left.width - 1);
            sum += std::abs(replicated(left, column, y + dy) - replicated(right, column - d, y + dy));
        }
    }
    return static_cast<std::uint16_t>(sum);
}

template <typename T>
std::uint64_t census_word(Plane<const T> image, int x, int y) {
    const T centre = image.at(x, y);
    std::uint64_t word = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            if (dx != 0 || dy != 0) {
                word = word << 1 | (replicated(image, x + dx, y + dy) < centre ? 1U : 0U);
            }
        }
    }
    return word;
}

/// Sets every cost: cost_of(x, y, d) inside the right image, `outside` elsewhere.
template <typename T, typename CostOf>
void fill(Volume<T> costs, DisparityRange range, Rows rows, T outside, CostOf cost_of) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < costs.width; ++x) {
            for (int k = 0; k < range.count; ++k) {
                const int d = range.first + k;
                costs.pixel(x, y)[k] = x - d >= 0 && x - d < costs.width ? cost_of(x, y, d) : outside;
            }
        }
    }
}

void sad_in_one_pass(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
                     Volume<std::uint16_t> costs, Rows rows) {
    fill(costs, range, rows, sad_outside, [&](int x, int y, int d) { return window_sum(left, right, x, y, d); });
}

void pixels_as_words(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        std::copy_n(image.row(y), image.width, words.row(y));
    }
}

void matching_cost_in_one_pass(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                               Volume<std::uint8_t> costs, Rows rows) {
    fill(costs, range, rows, census_outside, [&](int x, int y, int d) {
        return static_cast<std::uint8_t>(__builtin_popcountll(census_word(left, x, y) ^ census_word(right, x - d, y)));
    });
}

}  // namespace

const KernelSteps& steps_as_described() {
    static const KernelSteps as_described = [] {
        KernelSteps steps = bench::naive_steps(bench::Build::not_vectorised);
        steps.matching.sad = sad_in_one_pass;
        steps.matching.census_costs[0] = {pixels_as_words, matching_cost_in_one_pass};
        return steps;
    }();
    return as_described;
}

}  // namespace disparityd::lab
