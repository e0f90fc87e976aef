// SPDX-License-Identifier: Apache-2.0
// The cost census-7x5+gradient of steps 3 and 4.
#include <algorithm>
#include <bit>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr int radius_x = 3;
constexpr int radius_y = 2;
constexpr int max_gradient = 32;
constexpr int max_gradient_cost = 12;
constexpr int outside = 18;
constexpr int gradient_bit = 32;  // the lowest one of the gradient byte in a word

int pixel(Plane<const std::uint8_t> image, int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
}

std::uint64_t census_bits(Plane<const std::uint8_t> image, int x, int y) {
    std::uint64_t bits = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            const bool centre = dx == 0 && dy == 0;
            const bool corner = std::abs(dx) == radius_x && std::abs(dy) == radius_y;
            if (!centre && !corner) {
                bits = bits << 1 | (pixel(image, x + dx, y + dy) < image.at(x, y) ? 1U : 0U);
            }
        }
    }
    return bits;
}

std::uint64_t gradient_byte(Plane<const std::uint8_t> image, int x, int y) {
    int sobel = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        sobel += (dy == 0 ? 2 : 1) * (pixel(image, x + 1, y + dy) - pixel(image, x - 1, y + dy));
    }
    // An arithmetic shift rounds down.
    return static_cast<std::uint64_t>(128 + (std::clamp(sobel, -max_gradient, max_gradient) >> 1));
}

int cost_of_words(std::uint64_t left, std::uint64_t right) {
    constexpr std::uint64_t census_part = 0x3fffffff;
    const int gradient = std::abs(static_cast<int>(left >> gradient_bit) - static_cast<int>(right >> gradient_bit));
    return std::popcount((left ^ right) & census_part) + std::min(gradient, max_gradient_cost);
}

int average(int a, int b) {
    return (a + b + 1) / 2;
}

}  // namespace

void census_gradient(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < image.width; ++x) {
            words.at(x, y) = gradient_byte(image, x, y) << gradient_bit | census_bits(image, x, y);
        }
    }
}

void census_gradient_cost(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                          Volume<std::uint8_t> costs, Rows rows) {
    const int width = left.width;
    for (int y = rows.first; y < rows.last; ++y) {
        const int above = std::max(y - 1, 0);
        const int below = std::min(y + 1, left.height - 1);
        for (int x = 0; x < width; ++x) {
            for (int k = 0; k < range.count; ++k) {
                const int match = x - range.first - k;
                const auto of_row = [&](int row) { return cost_of_words(left.at(x, row), right.at(match, row)); };
                costs.pixel(x, y)[k] = static_cast<std::uint8_t>(
                    match < 0 || match >= width ? outside : average(average(of_row(above), of_row(below)), of_row(y)));
            }
        }
    }
}

}  // namespace disparityd::reference
