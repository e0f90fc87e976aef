// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "kernels/depth_error.h"
#include "tests/kernels/support.h"

// What the steps after matching are tested with, on every back end.
namespace disparityd::test {

/// Any size from one pixel on; often narrower than a vector.
struct Size {
    explicit Size(Random& random)
        : width(pick(random, 1, pick(random, 0, 2) == 0 ? 40 : 300)),
          height(pick(random, 1, pick(random, 0, 4) == 0 ? 120 : 30)) {}
    Size(int of_width, int of_height) : width(of_width), height(of_height) {}
    int width, height;
};

inline DisparityRange any_range(Random& random) {
    return {pick(random, 0, 2) == 0 ? pick(random, -256, 256) : pick(random, -20, 20), 16 * pick(random, 1, 16)};
}

/// Disparities as matching leaves them: patches, slopes, and some noise, with holes; or any words at all.
inline Image<std::int16_t> disparities(Random& random, Size size, DisparityRange range) {
    Image<std::int16_t> image(size.width, size.height);
    const int kind = pick(random, 0, 4);
    const int holes = pick(random, 0, 2) * pick(random, 0, 50);
    const int least = 16 * range.first;
    const int most = 16 * (range.first + range.count - 1);
    for (int y = 0; y < size.height; ++y) {
        int patch = pick(random, least, most);
        for (int x = 0; x < size.width; ++x) {
            if (pick(random, 0, 19) == 0) {
                patch = pick(random, least, most);
            }
            const int value = kind == 0   ? pick(random, -32768, 32767)
                              : kind == 1 ? least
                              : kind == 2 ? patch
                              : kind == 3 ? least + (x + y) * 3
                                          : patch + pick(random, -9, 9);
            const bool hole = pick(random, 1, 100) <= holes;
            image.at(x, y) = hole ? invalid_disparity(range) : static_cast<std::int16_t>(value);
        }
    }
    return image;
}

/// Two images that agree in part: of any contrast, moved by a few pixels, with some pixels of the right one drawn anew.
struct TexturedPair {
    TexturedPair(Random& random, Size size) : left(size.width, size.height), right(size.width, size.height) {
        const int contrast = pick(random, 0, 1) == 0 ? pick(random, 0, 30) : 255;
        const int darkest = pick(random, 0, 255 - contrast);
        const int shift = pick(random, -9, 9);
        for (std::uint8_t& value : left.pixels()) {
            value = static_cast<std::uint8_t>(pick(random, darkest, darkest + contrast));
        }
        for (int y = 0; y < size.height; ++y) {
            for (int x = 0; x < size.width; ++x) {
                const int from = std::clamp(x + shift, 0, size.width - 1);
                right.at(x, y) = pick(random, 0, 3) > 0
                                     ? left.at(from, y)
                                     : static_cast<std::uint8_t>(pick(random, darkest, darkest + contrast));
            }
        }
    }
    Image<std::uint8_t> left, right;
};

/// Winners in whole pixels, where matching finds none one less than the first; or any words at all.
inline Image<std::int16_t> winners(Random& random, Size size, DisparityRange range) {
    Image<std::int16_t> image(size.width, size.height);
    const bool any = pick(random, 0, 4) == 0;
    const int spread = pick(random, 0, 2) == 0 ? 2 : range.count;
    for (std::int16_t& value : image.pixels()) {
        value = static_cast<std::int16_t>(any ? pick(random, -32768, 32767)
                                              : range.first - 1 + pick(random, 0, std::min(spread, range.count)));
    }
    return image;
}

inline DepthScale any_scale(Random& random) {
    constexpr std::array<std::int64_t, 8> special = {0,       1,  2,       (1 << 30) - 1,
                                                     1 << 30, -1, -672000, std::int64_t{1} << 50};
    DepthScale scale;
    scale.k = pick(random, 0, 2) == 0 ? special[static_cast<std::size_t>(pick(random, 0, 7))]
                                      : std::int64_t{1} * pick(random, 1, 40000) * pick(random, 1, 20000);
    scale.offset16 = pick(random, 0, 3) == 0 ? pick(random, -100000, 100000) : pick(random, -3000, 3000);
    return scale;
}

/// Where a quotient in single precision is nearest to the next integer: exact multiples and one beside them.
inline DepthScale scale_at_an_edge(Random& random, int round) {
    const int n = pick(random, 1, 40000);
    const int quotient = round % 2 == 0 ? pick(random, 65530, 65540) : pick(random, 1, 65536);
    const std::int64_t k = std::max<std::int64_t>(1, std::int64_t{n} * quotient - n / 2 + pick(random, -1, 1));
    const int most = round % 3 == 0 ? (1 << 24) + pick(random, -70000, 9) : (1 << 30) + pick(random, -70000, 9);
    return {std::min<std::int64_t>(k, most), pick(random, -20, 8000)};
}

/// The scale of depth errors of any scale of depth, and offsets that no calibration has.
inline DepthErrorScale any_error_scale(Random& random) {
    constexpr std::array<int, 4> special = {std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
                                            (1 << 30) - 1, 1 << 30};
    const DepthScale scale = any_scale(random);
    const int offset16 =
        pick(random, 0, 9) == 0 ? special[static_cast<std::size_t>(pick(random, 0, 3))] : scale.offset16;
    return depth_error_scale(scale.k, offset16, pick(random, 0, 1) == 0 ? 64 : pick(random, 1, 1024));
}

/// Where a quotient in single precision is nearest to the next integer, and the limits of the ways to divide.
inline DepthErrorScale error_scale_at_an_edge(Random& random, int round) {
    const std::int64_t n = pick(random, 1, round % 4 == 0 ? 5000 : 400);
    const int quotient = round % 2 == 0 ? pick(random, 65530, 65540) : pick(random, 1, 65536);
    const std::int64_t numerator = std::max<std::int64_t>(0, n * n * quotient - n * n / 2 + pick(random, -1, 1));
    const int most = round % 3 == 0 ? (1 << 23) + pick(random, -9, 9) : (1 << 30) + pick(random, -9, 9);
    return {true, std::min<std::int64_t>(numerator, most), pick(random, -20, 8000)};
}

inline Image<std::int16_t> every_disparity() {
    Image<std::int16_t> all(256, 256);
    for (int i = 0; i < 65536; ++i) {
        all.at(i % 256, i / 256) = static_cast<std::int16_t>(i - 32768);
    }
    return all;
}

using Shape = bool (*)(int x, int y, int side);

/// Regions that meet themselves again far from where they began.
inline constexpr std::array<Shape, 5> speckle_shapes = {
    [](int x, int y, int side) { return x % 2 == 0 || y == side - 1; },
    [](int x, int y, int) { return x % 3 != 1 || y == 0; },
    [](int x, int y, int side) {
        const int ring = std::min({x, y, side - 1 - x, side - 1 - y});
        return ring % 2 == 0 ? !(x == ring && y == ring + 1) : x == ring && y == ring;
    },
    [](int x, int y, int) { return (x + y) % 2 == 0; },
    [](int, int, int) { return true; },
};

inline Image<std::int16_t> slope_in(Shape shape, int side, std::int16_t invalid) {
    Image<std::int16_t> image(side, side, invalid);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            image.at(x, y) = shape(x, y, side) ? static_cast<std::int16_t>(x + y) : invalid;
        }
    }
    return image;
}

}  // namespace disparityd::test
