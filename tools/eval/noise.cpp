// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/noise.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace disparityd::eval {
namespace {

constexpr int draws_of_a_pixel = 6;
constexpr std::int64_t mean_of_twelve = 12 * 65535 / 2;

/// Returns the next Gaussian value, sigma 65536, mean 0.
std::int64_t next_gaussian(std::mt19937& random) {
    std::int64_t sum = -mean_of_twelve;
    for (int i = 0; i < draws_of_a_pixel; ++i) {
        const auto bits = static_cast<std::uint32_t>(random());
        sum += (bits & 0xFFFFU) + (bits >> 16);
    }
    return sum;
}

/// Returns value * sigma in whole grey levels; both factors are in 1/65536. Halves are rounded up.
int grey_levels(std::int64_t value, std::int64_t sigma) {
    constexpr int fraction_bits = 32;
    return static_cast<int>((value * sigma + (std::int64_t{1} << (fraction_bits - 1))) >> fraction_bits);
}

/// Returns what each pixel's noise is, sigma 65536, row by row.
std::vector<std::int64_t> noise_values(int width, int height, std::uint32_t seed, NoiseKind kind) {
    const int border = kind == NoiseKind::shared ? 2 : 0;
    const int drawn_width = width + border;
    std::vector<std::int64_t> drawn;
    std::mt19937 random(seed);
    for (int i = 0; i < drawn_width * (height + border); ++i) {
        drawn.push_back(next_gaussian(random));
    }
    if (kind == NoiseKind::independent) {
        return drawn;
    }
    std::vector<std::int64_t> values;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::int64_t sum = 0;
            for (int i = 0; i < 9; ++i) {
                sum += drawn[static_cast<std::size_t>((y + i / 3) * drawn_width + x + i % 3)];
            }
            values.push_back(sum / 3);
        }
    }
    return values;
}

}  // namespace

std::uint32_t noise_seed(const std::string& scene, const std::string& eye) {
    std::uint32_t hash = 2166136261U;
    for (const char c : scene + '/' + eye) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    }
    return hash;
}

cv::Mat with_noise(const cv::Mat& image, double sigma, std::uint32_t seed, NoiseKind kind) {
    cv::Mat noisy = image.clone();
    const auto sigma_fixed = static_cast<std::int64_t>(std::llround(sigma * 65536));
    const int channels = noisy.channels();
    const std::vector<std::int64_t> values = noise_values(noisy.cols, noisy.rows, seed, kind);
    auto value_of_pixel = values.begin();
    for (int y = 0; y < noisy.rows; ++y) {
        auto* pixel = noisy.ptr<std::uint8_t>(y);
        for (int x = 0; x < noisy.cols; ++x, pixel += channels) {
            const int added = grey_levels(*value_of_pixel++, sigma_fixed);
            std::transform(pixel, pixel + channels, pixel, [added](std::uint8_t value) {
                return static_cast<std::uint8_t>(std::clamp(value + added, 0, 255));
            });
        }
    }
    return noisy;
}

void add_noise(Scene& scene, double sigma, NoiseKind kind) {
    scene.left = with_noise(scene.left, sigma, noise_seed(scene.name, "left"), kind);
    scene.right = with_noise(scene.right, sigma, noise_seed(scene.name, "right"), kind);
}

}  // namespace disparityd::eval
