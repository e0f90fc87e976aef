// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/kernels/support.h"

// Frames and maps that rectification is tested with, on every back end.
namespace disparityd::test {

inline constexpr PixelFormat pixel_formats[] = {PixelFormat::grey8, PixelFormat::yuyv, PixelFormat::bgr24};

/// A frame that ends where its memory ends, so that a sanitizer sees what is read beyond.
struct Source {
    Source(Random& random, PixelFormat format, int eye_width, int height) {
        const int padding = pick(random, 0, 1) * pick(random, 0, 40);
        const int row = 2 * eye_width * bytes_per_pixel(format);
        const auto size = static_cast<std::size_t>(row + (height - 1) * (row + padding));
        bytes.resize(size);
        for (std::uint8_t& byte : bytes) {
            byte = static_cast<std::uint8_t>(pick(random, 0, 7) == 0 ? 255 : pick(random, 0, 255));
        }
        raw = {bytes.data(), format, eye_width, height, row + padding};
    }
    std::vector<std::uint8_t> bytes;
    RawImage raw;
};

/// A map and the ways in which maps may be: smooth as a camera's (of any scale, turned, mirrored, across the borders),
/// or without any order.
struct Map {
    Map(Random& random, int map_width, int map_height, const RawImage& source)
        : width(map_width), height(map_height), xy(2 * map_width, map_height), fraction(map_width, map_height) {
        pick(random, 0, 2) > 0 ? smooth(random, source) : anywhere(random, source);
    }

    void smooth(Random& random, const RawImage& source) {
        const double scale = std::ldexp(pick(random, 64, 128), pick(random, -8, -5));
        const double turn = pick(random, 0, 3) == 0 ? pick(random, -180, 180) : pick(random, -60, 60) / 30.0;
        const double bend = pick(random, -100, 100) / 1e6;
        const double cosine = scale * std::cos(turn * 3.14159 / 180);
        const double sine = scale * std::sin(turn * 3.14159 / 180);
        const double mirror = pick(random, 0, 7) == 0 ? -1 : 1;
        const double centre_x = source.eye_width / 2.0 + pick(random, -10, 10);
        const double centre_y = source.height / 2.0 + pick(random, -10, 10);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double dx = mirror * (x - width / 2.0);
                const double dy = y - height / 2.0;
                const double out = 1 + bend * (dx * dx + dy * dy);
                set(x, y, centre_x + out * (cosine * dx - sine * dy), centre_y + out * (sine * dx + cosine * dy));
            }
        }
    }
    void anywhere(Random& random, const RawImage& source) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool far = pick(random, 0, 19) == 0;
                const int least = far ? -32768 : -3;
                xy.at(2 * x, y) = static_cast<std::int16_t>(pick(random, least, far ? 32767 : source.eye_width + 2));
                xy.at(2 * x + 1, y) = static_cast<std::int16_t>(pick(random, least, far ? 32767 : source.height + 2));
                fraction.at(x, y) = static_cast<std::uint16_t>(pick(random, 0, 1023));
            }
        }
    }
    void set(int x, int y, double source_x, double source_y) {
        const auto fixed = [](double v) { return static_cast<int>(std::lround(std::clamp(v, -900.0, 900.0) * 32)); };
        xy.at(2 * x, y) = static_cast<std::int16_t>(fixed(source_x) >> 5);
        xy.at(2 * x + 1, y) = static_cast<std::int16_t>(fixed(source_y) >> 5);
        fraction.at(x, y) = static_cast<std::uint16_t>((fixed(source_y) & 31) * 32 + (fixed(source_x) & 31));
    }

    RectifyMap view() const { return {xy.plane(), fraction.plane()}; }

    int width, height;
    Image<std::int16_t> xy;
    Image<std::uint16_t> fraction;
};

/// YUYV of the pixels that give the largest and the smallest sums and slopes.
inline Source extremes(Random& random, int eye_width, int height) {
    Source source(random, PixelFormat::yuyv, eye_width, height);
    for (std::uint8_t& byte : source.bytes) {
        byte = static_cast<std::uint8_t>(pick(random, 0, 3) == 0 ? pick(random, 0, 255) : 255 * pick(random, 0, 1));
    }
    return source;
}

/// A shifted image, pixel by pixel with the next of all fractions.
inline Map every_fraction(Random& random, int width, int height, const RawImage& source) {
    Map map(random, width, height, source);
    int fraction = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            map.set(x, y, x + 5, y + 2);
            map.fraction.at(x, y) = static_cast<std::uint16_t>(fraction++ % 1024);
        }
    }
    return map;
}

/// YUYV, 512 x 256 an eye, 2048 bytes a row: all pairs of chroma with a luma.
inline std::vector<std::uint8_t> every_colour(int luma) {
    std::vector<std::uint8_t> bytes(4 * 256 * 256 * 2);
    for (int i = 0; i < 256 * 256; ++i) {
        // The left eye; the right one stays 0.
        std::uint8_t* pair = bytes.data() + 2048 * (i / 256) + 4 * (i % 256);
        pair[0] = static_cast<std::uint8_t>(luma);
        pair[1] = static_cast<std::uint8_t>(i % 256);
        pair[2] = static_cast<std::uint8_t>(255 - luma);
        pair[3] = static_cast<std::uint8_t>(i / 256);
    }
    return bytes;
}

}  // namespace disparityd::test
