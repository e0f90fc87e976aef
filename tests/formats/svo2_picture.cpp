// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/svo2_picture.h"

namespace disparityd::test {
namespace {

constexpr int corner_distance = 4;  // px: an encoder keeps what is no finer

std::uint32_t noise(int x, int y, std::uint32_t seed) {
    std::uint32_t value =
        static_cast<std::uint32_t>(x) * 0x9E3779B1U + static_cast<std::uint32_t>(y) * 0x85EBCA77U + seed;
    value = (value ^ (value >> 15U)) * 0x2C1B3C6DU;
    value = (value ^ (value >> 12U)) * 0x297A2D39U;
    return value ^ (value >> 15U);
}

int corner(int x, int y, std::uint32_t seed) {
    return 32 + static_cast<int>(noise(x, y, seed) % 192U);
}

/// Between the noise of four corners. The place is not negative.
std::uint8_t texture(int x, int y, std::uint32_t seed) {
    constexpr int d = corner_distance;
    const int left = x / d;
    const int top = y / d;
    const int to_right = x % d;
    const int down = y % d;
    const int above = corner(left, top, seed) * (d - to_right) + corner(left + 1, top, seed) * to_right;
    const int below = corner(left, top + 1, seed) * (d - to_right) + corner(left + 1, top + 1, seed) * to_right;
    return static_cast<std::uint8_t>((above * (d - down) + below * down) / (d * d));
}

}  // namespace

Svo2Picture svo2_picture(int eye_width, int height, int disparity, int number) {
    Svo2Picture picture{2 * eye_width, height, {}, {}, {}};
    const int start = 1 << 16;  // the texture moves down from here, and its rows stay positive
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * eye_width; ++x) {
            const bool right = x >= eye_width;
            const int column = right ? x - eye_width + disparity : x;
            const int row = start + y - 2 * number;
            picture.luma.push_back(texture(column, row, 1));
            if (x % 2 == 0 && y % 2 == 0) {
                picture.blue.push_back(texture(column / 2, row / 2, 2));
                picture.red.push_back(texture(column / 2, row / 2, 3));
            }
        }
    }
    return picture;
}

std::vector<std::uint8_t> svo2_rgb(const Svo2Picture& picture) {
    std::vector<std::uint8_t> pixels;
    pixels.reserve(3 * picture.luma.size());
    const auto width = static_cast<std::size_t>(picture.width);
    for (std::size_t i = 0; i < picture.luma.size(); ++i) {
        const std::size_t x = i % width;
        const std::size_t y = i / width;
        const std::uint8_t grey = picture.luma[i];
        pixels.insert(pixels.end(),
                      {grey, static_cast<std::uint8_t>(255 - grey), picture.blue[y / 2 * (width / 2) + x / 2]});
    }
    return pixels;
}

}  // namespace disparityd::test
