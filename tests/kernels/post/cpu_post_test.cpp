// SPDX-License-Identifier: Apache-2.0
// Inputs that random ones of tests/kernels/check do not hit.
#include <algorithm>

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

    // In parts of `rows` rows.
    void expect_same_guided_medians(const Image<std::int16_t>& image, const Image<std::uint8_t>& guide,
                                    std::int16_t invalid, int rows) {
        for (const int size : {5, 7}) {
            Image<std::int16_t> expected(image.width(), image.height()), found(image.width(), image.height());
            reference::guided_median(image.plane(), guide.plane(), invalid, size, expected.plane(), expected.rows());
            for (int y = 0; y < image.height(); y += rows) {
                const Rows part{y, std::min(y + rows, image.height())};
                steps().guided_median(image.plane(), guide.plane(), invalid, size, found.plane(), part);
            }
            EXPECT_TRUE(found.pixels() == expected.pixels()) << "size " << size << ", parts of " << rows << " rows";
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

// Widths around registers and blocks of columns, parts of one row and more, disparities of every number of bits.
TEST_P(CpuPost, GuidedMedianEqualsTheReferenceAtTheEdges) {
    Random random(89);
    const Image<std::int16_t> rejected(130, 9, -7);
    const Image<std::uint8_t> dark(130, 9, 0);
    expect_same_guided_medians(rejected, dark, -7, 9);
    for (int bits = 0; bits <= 16; ++bits) {
        for (const int width : {1, 2, 15, 64, 65, 127, 129, 257}) {
            const int height = pick(random, 1, 20);
            const int least = pick(random, -32768, 32768 - (1 << bits));
            const auto invalid = static_cast<std::int16_t>(pick(random, least, least + (1 << bits) - 1));
            Image<std::int16_t> image(width, height);
            for (std::int16_t& value : image.pixels()) {
                value = static_cast<std::int16_t>(pick(random, least, least + (1 << bits) - 1));
            }
            const Image<std::uint8_t> guide = noise(random, width, height, 0, pick(random, 0, 255));
            expect_same_guided_medians(image, guide, invalid, 1);
            expect_same_guided_medians(image, guide, static_cast<std::int16_t>(least - 1), pick(random, 2, 20));
            ASSERT_FALSE(HasFailure()) << width << "x" << height << ", " << bits << " bits";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuPost, testing::ValuesIn(cpu::instruction_sets()), name_of);

}  // namespace
}  // namespace disparityd::test
