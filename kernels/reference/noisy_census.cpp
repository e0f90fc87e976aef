// SPDX-License-Identifier: Apache-2.0
// Step 3 of the cost census-7x5+gradient at noise levels above 0.
#include <algorithm>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr int radius_x = 3;
constexpr int radius_y = 2;
constexpr int gradient_bit = 32;  // the lowest one of the gradient byte in a word
constexpr int largest_gradient = 16;

int pixel(Plane<const std::uint8_t> image, int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
}

std::uint64_t census_bits(Plane<const std::uint8_t> image, int centre, int coarseness, int x, int y) {
    std::uint64_t bits = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            const bool is_centre = dx == 0 && dy == 0;
            const bool corner = std::abs(dx) == radius_x && std::abs(dy) == radius_y;
            if (!is_centre && !corner) {
                bits = bits << 1 | (pixel(image, x + dx, y + coarseness * dy) < centre - coarseness ? 1U : 0U);
            }
        }
    }
    return bits;
}

std::uint64_t gradient_byte(Plane<const std::uint8_t> smoothed, int coarseness, int x, int y) {
    int sobel = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        sobel += (dy == 0 ? 2 : 1) * (pixel(smoothed, x + 1, y + dy) - pixel(smoothed, x - 1, y + dy));
    }
    // An arithmetic shift rounds down.
    return static_cast<std::uint64_t>(128 + std::clamp(sobel >> coarseness, -largest_gradient, largest_gradient));
}

}  // namespace

void smooth(Plane<const std::uint8_t> image, Plane<std::uint8_t> smoothed, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < image.width; ++x) {
            int sum = 0;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    sum += (2 - std::abs(dx)) * (2 - std::abs(dy)) * pixel(image, x + dx, y + dy);
                }
            }
            smoothed.at(x, y) = static_cast<std::uint8_t>((sum + 8) / 16);
        }
    }
}

void noisy_census(Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed, int coarseness,
                  Plane<std::uint64_t> words, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < image.width; ++x) {
            words.at(x, y) = gradient_byte(smoothed, coarseness, x, y) << gradient_bit |
                             census_bits(image, smoothed.at(x, y), coarseness, x, y);
        }
    }
}

}  // namespace disparityd::reference
