// SPDX-License-Identifier: Apache-2.0
// Inputs that random ones of tests/kernels/check do not hit.
#include <gtest/gtest.h>

#include "tests/kernels/instruction_sets.h"
#include "tests/kernels/rectify/rectify_inputs.h"

namespace disparityd::test {
namespace {

class CpuRectify : public StepsOfInstructionSet {};

// Every weight with the pixels that give the largest and the smallest sums and slopes.
TEST_P(CpuRectify, EqualsTheReferenceOnEveryFractionBetweenExtremes) {
    Random random(71);
    const Source source = extremes(random, 80, 64);
    const Map map = every_fraction(random, 64, 60, source.raw);
    const Rectifier rectifier{true, map.view(), map.view()};
    for (const Eye eye : {Eye::left, Eye::right}) {
        Image<std::uint8_t> expected(64, 60), found(64, 60), expected_colour(3 * 64, 60), found_colour(3 * 64, 60);
        reference::rectify(source.raw, eye, rectifier, expected.plane(), expected.rows());
        steps().rectify(source.raw, eye, rectifier, found.plane(), found.rows());
        EXPECT_TRUE(found.pixels() == expected.pixels());
        reference::rectify_colour(source.raw, eye, rectifier, expected_colour.plane(), expected.rows());
        steps().rectify_colour(source.raw, eye, rectifier, found_colour.plane(), found.rows());
        EXPECT_TRUE(found_colour.pixels() == expected_colour.pixels());
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
