// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace disparityd {

namespace {

constexpr int side = 8;  // of a block
constexpr int least_pixels = 48;
constexpr int most_blocks = 1024;
constexpr int percentile = 5;
constexpr int nothing = -1;

// A darker picture has less contrast for the same noise: its noise counts as if it were this bright.
constexpr int dark = 64;
constexpr int most = 65535;

// floor(sqrt(value)): exact below 2^43, since a square root is rounded once.
int root(std::int64_t value) {
    return static_cast<int>(std::sqrt(static_cast<double>(value)));
}

// All ones where the pixel is 0 or 255, else 0.
std::uint8_t if_clipped(std::uint8_t grey) {
    return static_cast<std::uint8_t>(grey + 1) < 2 ? 255 : 0;
}

struct Pair {
    Plane<const std::uint8_t> left;
    Plane<const std::uint8_t> right;
    Plane<const std::int16_t> disparity;
    Plane<const std::uint8_t> confidence;
};

// Of the measured pixels of the left eye.
struct Brightness {
    std::int64_t sum = 0;
    std::int64_t pixels = 0;
};

// Holds a block's pixels side by side, which compilers make vectors of.
struct Block {
    std::array<std::uint8_t, side * side> left;
    std::array<std::uint8_t, side * side> match;
    std::array<std::uint8_t, side * side> confidence;
};

void gather(const Pair& pair, int first_x, int first_y, Block& block) {
    std::size_t at = 0;
    for (int y = first_y; y < first_y + side; ++y) {
        const std::uint8_t* const right = pair.right.row(y);
        const std::int16_t* const disparity = pair.disparity.row(y);
        std::copy_n(pair.left.row(y) + first_x, side, &block.left[at]);
        std::copy_n(pair.confidence.row(y) + first_x, side, &block.confidence[at]);
        for (int x = first_x; x < first_x + side; ++x) {
            block.match[at++] = right[std::clamp(x - ((disparity[x] + 8) >> 4), 0, pair.right.width - 1)];
        }
    }
}

// Returns how many pixels were measured, negative where one of them may be clipped, and makes the others 0.
int measured_pixels(Block& block) {
    std::uint8_t pixels = 0;
    std::uint8_t clipped = 0;
    for (std::size_t i = 0; i < block.left.size(); ++i) {
        const auto measured = static_cast<std::uint8_t>(block.confidence[i] > 0 ? 255 : 0);
        const int suspect = measured & (if_clipped(block.left[i]) | if_clipped(block.match[i]));
        clipped = static_cast<std::uint8_t>(clipped | suspect);
        pixels = static_cast<std::uint8_t>(pixels - measured);
        block.left[i] = static_cast<std::uint8_t>(block.left[i] & measured);
        block.match[i] = static_cast<std::uint8_t>(block.match[i] & measured);
    }
    return clipped != 0 ? -pixels : pixels;
}

// The noise of one eye in 1/256 grey levels, or nothing where too little was measured or a pixel may be clipped. Sums
// of 64 pixels fit the narrow types.
int noise_of_block(const Pair& pair, int first_x, int first_y, Brightness& brightness) {
    Block block;
    gather(pair, first_x, first_y, block);
    const int pixels = measured_pixels(block);
    std::array<std::int16_t, side * side> differences;
    std::uint16_t grey = 0;
    std::int16_t sum = 0;
    for (std::size_t i = 0; i < block.left.size(); ++i) {
        differences[i] = static_cast<std::int16_t>(block.left[i] - block.match[i]);
        grey = static_cast<std::uint16_t>(grey + block.left[i]);
        sum = static_cast<std::int16_t>(sum + differences[i]);
    }
    int squares = 0;
    for (const std::int16_t difference : differences) {
        squares += difference * difference;
    }
    brightness.sum += grey;
    brightness.pixels += std::abs(pixels);
    if (pixels < least_pixels) {
        return nothing;
    }
    // Both eyes add as much to the variance of their difference.
    const std::int64_t n = pixels;
    return root((n * squares - std::int64_t{sum} * sum) * (256 * 256 / 2) / (n * n));
}

}  // namespace

NoiseEstimate estimate_noise(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                             Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence) {
    const int columns = left.width / side;
    const int rows = left.height / side;
    int step = 1;
    while (((columns + step - 1) / step) * ((rows + step - 1) / step) > most_blocks) {
        ++step;
    }
    std::array<int, most_blocks> noise;
    int blocks = 0;
    Brightness brightness;
    for (int row = 0; row < rows; row += step) {
        for (int column = 0; column < columns; column += step) {
            const int found =
                noise_of_block({left, right, disparity, confidence}, column * side, row * side, brightness);
            if (found != nothing) {
                noise[static_cast<std::size_t>(blocks++)] = found;
            }
        }
    }
    if (blocks == 0) {
        return {};
    }
    int* const chosen = noise.data() + blocks * percentile / 100;
    std::nth_element(noise.data(), chosen, noise.data() + blocks);
    const std::int64_t if_dark =
        std::int64_t{*chosen} * dark * brightness.pixels / std::max<std::int64_t>(brightness.sum, 1);
    return {static_cast<int>(std::clamp<std::int64_t>(if_dark, *chosen, most)), blocks};
}

}  // namespace disparityd
