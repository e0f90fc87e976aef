// SPDX-License-Identifier: Apache-2.0
// Inputs that random ones of tests/kernels/check do not hit.
#include <gtest/gtest.h>

#include "tests/kernels/instruction_sets.h"
#include "tests/kernels/post/post_inputs.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

class CpuPost : public StepsOfInstructionSet {
protected:
    // For any number of bands that are worked on side by side.
    void expect_same_regions(const Image<std::int16_t>& image, std::int16_t invalid, int min_size) {
        Image<std::int16_t> expected = image;
        std::vector<std::byte> memory(reference::speckle_scratch(image.width(), image.height()));
        reference::speckle(expected.plane(), {invalid, min_size, 1}, memory);
        for (const int count : {1, 2, 5}) {
            Image<std::int16_t> found = image;
            std::vector<std::byte> scratch(steps().speckle_scratch(image.width(), image.height()));
            ShuffledWorkers workers(count, 7);
            steps().speckle(found.plane(), {invalid, min_size, 1}, scratch, workers);
            EXPECT_TRUE(found.pixels() == expected.pixels()) << count << " workers";
        }
    }
};

// Of 128, runs end where words of bits do.
TEST_P(CpuPost, SpeckleEqualsTheReferenceOnCombsSpiralsAndChessboards) {
    constexpr std::int16_t invalid = -16;
    for (const int side : {128, 131}) {
        for (const Shape shape : speckle_shapes) {
            for (const int min_size : {2, 500, 8000, side * side, side * side + 1}) {
                expect_same_regions(slope_in(shape, side, invalid), invalid, min_size);
                ASSERT_FALSE(HasFailure()) << side << ", size " << min_size;
            }
        }
    }
}

// Where a quotient in single precision is nearest to the next integer: exact multiples and one beside them.
TEST_P(CpuPost, DepthEqualsTheReferenceForEveryDisparityAtTheEdges) {
    const Image<std::int16_t> all = every_disparity();
    Random random(85);
    for (int round = 0; round < 60; ++round) {
        const DepthScale scale = scale_at_an_edge(random, round);
        Image<std::uint16_t> expected(256, 256), found(256, 256);
        reference::depth(all.plane(), -16, scale, expected.plane(), all.rows());
        steps().depth(all.plane(), -16, scale, found.plane(), all.rows());
        ASSERT_TRUE(found.pixels() == expected.pixels()) << "k " << scale.k << ", offset " << scale.offset16;
    }
}

// Numerators around the limits of each way to divide, with disparities around the clamped ones.
TEST_P(CpuPost, DepthErrorEqualsTheReferenceForEveryDisparityAtTheEdges) {
    const Image<std::int16_t> all = every_disparity();
    const Image<std::uint8_t> measured(256, 256, 1);
    Random random(87);
    for (int round = 0; round < 80; ++round) {
        const DepthErrorScale scale = error_scale_at_an_edge(random, round);
        Image<std::uint16_t> expected(256, 256), found(256, 256);
        reference::depth_error(all.plane(), measured.plane(), scale, expected.plane(), all.rows());
        steps().depth_error(all.plane(), measured.plane(), scale, found.plane(), all.rows());
        ASSERT_TRUE(found.pixels() == expected.pixels())
            << "round " << round << ", numerator " << scale.numerator << ", offset " << scale.offset16;
    }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuPost, testing::ValuesIn(cpu::instruction_sets()), name_of);

}  // namespace
}  // namespace disparityd::test
