// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "tests/kernels/guarded.h"
#include "tests/kernels/instruction_sets.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr PixelFormat formats[] = {PixelFormat::grey8, PixelFormat::yuyv, PixelFormat::bgr24};

// A frame that ends where its memory ends, so that a sanitizer sees what is read beyond.
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

// A map and the ways in which maps may be: smooth as a camera's (of any scale, turned, mirrored, across the borders),
// or without any order.
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

class CpuRectify : public StepsOfInstructionSet {
protected:
    void compare(const Source& source, const Rectifier& rectifier, int width, int height) {
        const auto rectify = [&](Eye eye) {
            return [&source, &rectifier, eye](const KernelSteps& of, Plane<std::uint8_t> out, Rows rows) {
                of.rectify(source.raw, eye, rectifier, out, rows);
            };
        };
        compare(width, height, rectify(Eye::left));
        compare(width, height, rectify(Eye::right));
        compare(3 * width, height, [&](const KernelSteps& of, Plane<std::uint8_t> out, Rows rows) {
            of.rectify_colour(source.raw, rectifier, out, rows);
        });
        ASSERT_FALSE(HasFailure()) << "from " << source.raw.eye_width << "x" << source.raw.height << ", format "
                                   << static_cast<int>(source.raw.format);
    }

private:
    template <typename Step>
    void compare(int width, int height, Step step) {
        const GuardedPlane<std::uint8_t> expected(width, height);
        const GuardedPlane<std::uint8_t> found(width, height);
        const int middle = height / 2;
        step(reference::steps, expected.plane(), {0, height});
        step(steps(), found.plane(), {middle, height});
        step(steps(), found.plane(), {0, middle});
        EXPECT_TRUE(found.intact());
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ASSERT_EQ(found.plane().at(x, y), expected.plane().at(x, y))
                    << x << "," << y << " of " << width << "x" << height;
            }
        }
    }
};

TEST_P(CpuRectify, EqualsTheReferenceOnAnyMap) {
    Random random(70);
    for (int round = 0; round < 150; ++round) {
        const PixelFormat format = formats[round % 3];
        const int eye_width = 2 * (pick(random, 0, 3) == 0 ? pick(random, 1, 12) : pick(random, 30, 150));
        const Source source(random, format, eye_width, pick(random, 1, pick(random, 1, 3) == 1 ? 5 : 90));
        const int width = pick(random, 1, pick(random, 0, 3) == 0 ? 30 : 250);
        const int height = pick(random, 1, 40);
        const Map left(random, width, height, source.raw);
        const Map right(random, width, height, source.raw);
        compare(source, {true, left.view(), right.view()}, width, height);
        ASSERT_FALSE(HasFailure()) << "round " << round;
    }
}

// Every weight with the pixels that give the largest and the smallest sums and slopes.
TEST_P(CpuRectify, EqualsTheReferenceOnEveryFractionBetweenExtremes) {
    Random random(71);
    Source source(random, PixelFormat::yuyv, 80, 64);
    for (std::uint8_t& byte : source.bytes) {
        byte = static_cast<std::uint8_t>(pick(random, 0, 3) == 0 ? pick(random, 0, 255) : 255 * pick(random, 0, 1));
    }
    Map map(random, 64, 60, source.raw);
    int fraction = 0;
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 64; ++x) {
            map.set(x, y, x + 5, y + 2);
            map.fraction.at(x, y) = static_cast<std::uint16_t>(fraction++ % 1024);
        }
    }
    compare(source, {true, map.view(), map.view()}, 64, 60);
}

TEST_P(CpuRectify, EqualsTheReferenceOnARegionWithoutMaps) {
    Random random(72);
    for (int round = 0; round < 60; ++round) {
        const int eye_width = 2 * pick(random, 1, 100);
        const Source source(random, formats[round % 3], eye_width, pick(random, 1, 20));
        const int width = pick(random, 1, eye_width);
        const int height = pick(random, 1, source.raw.height);
        const Rectifier region{
            false, {}, {}, pick(random, 0, eye_width - width), pick(random, 0, source.raw.height - height)};
        compare(source, region, width, height);
        ASSERT_FALSE(HasFailure()) << "round " << round;
    }
}

TEST_P(CpuRectify, EqualsTheReferenceOnEveryColour) {
    for (int luma = 0; luma < 256; luma += 15) {
        std::vector<std::uint8_t> bytes(4 * 256 * 256 * 2);
        for (int i = 0; i < 256 * 256; ++i) {
            // The left eye; the right one stays 0.
            std::uint8_t* pair = bytes.data() + 2048 * (i / 256) + 4 * (i % 256);
            pair[0] = static_cast<std::uint8_t>(luma);
            pair[1] = static_cast<std::uint8_t>(i % 256);
            pair[2] = static_cast<std::uint8_t>(255 - luma);
            pair[3] = static_cast<std::uint8_t>(i / 256);
        }
        const RawImage raw{bytes.data(), PixelFormat::yuyv, 512, 256, 2048};
        Image<std::uint8_t> expected(3 * 512, 256);
        Image<std::uint8_t> found(3 * 512, 256);
        reference::rectify_colour(raw, {}, expected.plane(), expected.rows());
        steps().rectify_colour(raw, {}, found.plane(), found.rows());
        ASSERT_TRUE(found.pixels() == expected.pixels()) << "luma " << luma;
    }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuRectify, testing::ValuesIn(cpu::instruction_sets()), name_of);

}  // namespace
}  // namespace disparityd::test
