// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/kernels/guarded.h"
#include "tests/kernels/instruction_sets.h"
#include "tests/kernels/rectify/rectify_inputs.h"

namespace disparityd::test {
namespace {

class CpuRectify : public StepsOfInstructionSet {
protected:
    void compare(const Source& source, const Rectifier& rectifier, int width, int height) {
        const auto rectify = [&](Eye eye) {
            return [&source, &rectifier, eye](const FrameSteps& of, Plane<std::uint8_t> out, Rows rows) {
                of.rectify(source.raw, eye, rectifier, out, rows);
            };
        };
        compare(width, height, rectify(Eye::left));
        compare(width, height, rectify(Eye::right));
        for (const Eye eye : {Eye::left, Eye::right}) {
            compare(3 * width, height, [&](const FrameSteps& of, Plane<std::uint8_t> out, Rows rows) {
                of.rectify_colour(source.raw, eye, rectifier, out, rows);
            });
        }
        ASSERT_FALSE(HasFailure()) << "from " << source.raw.eye_width << "x" << source.raw.height << ", format "
                                   << static_cast<int>(source.raw.format);
    }

private:
    template <typename Step>
    void compare(int width, int height, Step step) {
        const GuardedPlane<std::uint8_t> expected(width, height);
        const GuardedPlane<std::uint8_t> found(width, height);
        const int middle = height / 2;
        step(reference::steps.frame, expected.plane(), {0, height});
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
        const PixelFormat format = pixel_formats[round % 3];
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
    const Source source = extremes(random, 80, 64);
    const Map map = every_fraction(random, 64, 60, source.raw);
    compare(source, {true, map.view(), map.view()}, 64, 60);
}

TEST_P(CpuRectify, EqualsTheReferenceOnARegionWithoutMaps) {
    Random random(72);
    for (int round = 0; round < 60; ++round) {
        const int eye_width = 2 * pick(random, 1, 100);
        const Source source(random, pixel_formats[round % 3], eye_width, pick(random, 1, 20));
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
        const std::vector<std::uint8_t> bytes = every_colour(luma);
        const RawImage raw{bytes.data(), PixelFormat::yuyv, 512, 256, 2048};
        Image<std::uint8_t> expected(3 * 512, 256);
        Image<std::uint8_t> found(3 * 512, 256);
        reference::rectify_colour(raw, Eye::left, {}, expected.plane(), expected.rows());
        steps().rectify_colour(raw, Eye::left, {}, found.plane(), found.rows());
        ASSERT_TRUE(found.pixels() == expected.pixels()) << "luma " << luma;
    }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuRectify, testing::ValuesIn(cpu::instruction_sets()), name_of);

}  // namespace
}  // namespace disparityd::test
