// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_estimate.h"

#include <algorithm>
#include <array>

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

// floor(sqrt(value)).
int root(std::int64_t value) {
    std::int64_t found = 0;
    for (std::int64_t bit = std::int64_t{1} << 20; bit > 0; bit /= 2) {
        if ((found + bit) * (found + bit) <= value) {
            found += bit;
        }
    }
    return static_cast<int>(found);
}

bool is_clipped(int grey) {
    return grey == 0 || grey == 255;
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

// The noise of one eye in 1/256 grey levels, or nothing where too little was measured or a pixel may be clipped.
int noise_of_block(const Pair& pair, int first_x, int first_y, Brightness& brightness) {
    std::int64_t count = 0;
    std::int64_t sum = 0;
    std::int64_t squares = 0;
    bool clipped = false;
    for (int y = first_y; y < first_y + side; ++y) {
        const std::uint8_t* const left = pair.left.row(y);
        const std::uint8_t* const right = pair.right.row(y);
        const std::int16_t* const disparity = pair.disparity.row(y);
        const std::uint8_t* const confidence = pair.confidence.row(y);
        for (int x = first_x; x < first_x + side; ++x) {
            if (confidence[x] > 0) {
                const int match = std::clamp(x - ((disparity[x] + 8) >> 4), 0, pair.right.width - 1);
                const int difference = left[x] - right[match];
                clipped = clipped || is_clipped(left[x]) || is_clipped(right[match]);
                ++count;
                brightness.sum += left[x];
                sum += difference;
                squares += difference * difference;
            }
        }
    }
    brightness.pixels += count;
    if (count < least_pixels || clipped) {
        return nothing;
    }
    // Both eyes add as much to the variance of their difference.
    return root((count * squares - sum * sum) * (256 * 256 / 2) / (count * count));
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
