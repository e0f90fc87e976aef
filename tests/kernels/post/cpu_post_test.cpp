// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <gtest/gtest.h>

#include "tests/kernels/guarded.h"
#include "tests/kernels/instruction_sets.h"
#include "tests/kernels/post/post_inputs.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

template <typename T>
void copy(Plane<const T> from, Plane<T> to) {
    for (int y = 0; y < from.height; ++y) {
        std::copy_n(from.row(y), from.width, to.row(y));
    }
}

template <typename T>
::testing::AssertionResult same(const GuardedPlane<T>& found, const GuardedPlane<T>& expected) {
    if (!found.intact()) {
        return ::testing::AssertionFailure() << "wrote outside the plane";
    }
    const Plane<T> a = found.plane();
    const Plane<T> b = expected.plane();
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            if (a.at(x, y) != b.at(x, y)) {
                return ::testing::AssertionFailure() << x << "," << y << " of " << a.width << "x" << a.height << ": "
                                                     << +a.at(x, y) << " instead of " << +b.at(x, y);
            }
        }
    }
    return ::testing::AssertionSuccess();
}

// Two copies of a plane: one for the reference, one for the kernel.
template <typename T>
struct Both {
    explicit Both(Plane<const T> start) : expected(start.width, start.height), found(start.width, start.height) {
        copy(start, expected.plane());
        copy(start, found.plane());
    }
    GuardedPlane<T> expected, found;
};

class CpuPost : public StepsOfInstructionSet {
protected:
    static constexpr int rounds = 200;
    Serial serial_;

    // In two parts, so that a kernel that writes beyond its rows is found out.
    template <typename Step>
    static void in_parts(int height, Step step) {
        const int middle = height / 3;
        step(Rows{middle, height});
        step(Rows{0, middle});
    }

    void expect_errors_of_the_reference(const Image<std::int16_t>& disparity, const Image<std::uint8_t>& confidence,
                                        const DepthErrorScale& scale) {
        const int width = disparity.width();
        const int height = disparity.height();
        const Both<std::uint16_t> error(Image<std::uint16_t>(width, height, 4321).plane());
        reference::depth_error(disparity.plane(), confidence.plane(), scale, error.expected.plane(), {0, height});
        in_parts(height, [&](Rows rows) {
            steps().depth_error(disparity.plane(), confidence.plane(), scale, error.found.plane(), rows);
        });
        ASSERT_TRUE(same(error.found, error.expected))
            << width << 'x' << height << ", numerator " << scale.numerator << ", offset " << scale.offset16;
    }
};

TEST_P(CpuPost, LeftRightEqualsTheReference) {
    Random random(80);
    for (int round = 0; round < rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        Image<std::int16_t> left = winners(random, size, range);
        if (round % 2 == 0) {  // as matching has them: every pixel of the left image has a winner
            for (std::int16_t& winner : left.pixels()) {
                winner = static_cast<std::int16_t>(std::clamp<int>(winner, range.first, range.first + range.count - 1));
            }
        }
        const Image<std::int16_t> right = winners(random, size, range);
        const Both<std::int16_t> disparity(disparities(random, size, range).plane());
        reference::left_right(std::as_const(left).plane(), right.plane(), range, disparity.expected.plane(),
                              {0, size.height});
        in_parts(size.height, [&](Rows rows) {
            steps().left_right(std::as_const(left).plane(), right.plane(), range, disparity.found.plane(), rows);
        });
        ASSERT_TRUE(same(disparity.found, disparity.expected))
            << "round " << round << ", D " << range.count << " from " << range.first;
    }
}

TEST_P(CpuPost, MedianEqualsTheReference) {
    Random random(81);
    for (int round = 0; round < rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        const Image<std::int16_t> in = disparities(random, size, range);
        const Both<std::int16_t> out(Image<std::int16_t>(size.width, size.height, 77).plane());
        const int side = pick(random, 0, 1) == 0 ? 3 : 5;
        reference::median(in.plane(), invalid_disparity(range), side, out.expected.plane(), {0, size.height});
        in_parts(size.height, [&](Rows rows) {
            steps().median(in.plane(), invalid_disparity(range), side, out.found.plane(), rows);
        });
        ASSERT_TRUE(same(out.found, out.expected)) << "round " << round << ", side " << side;
    }
}

TEST_P(CpuPost, GuidedMedianEqualsTheReference) {
    Random random(87);
    for (int round = 0; round < rounds; ++round) {
        Size size(random);
        if (round % 20 == 0) {  // more columns than are worked on at a time
            size.width = pick(random, 505, 1040);
        }
        const DisparityRange range = any_range(random);
        const std::int16_t invalid = invalid_disparity(range);
        const Image<std::int16_t> in = disparities(random, size, range);
        const Image<std::uint8_t> guide = noise(random, size.width, size.height, 0, pick(random, 0, 255));
        const Both<std::int16_t> out(Image<std::int16_t>(size.width, size.height, 77).plane());
        const int side = pick(random, 0, 1) == 0 ? 5 : 7;
        reference::guided_median(in.plane(), guide.plane(), invalid, side, out.expected.plane(), {0, size.height});
        in_parts(size.height, [&](Rows rows) {
            steps().guided_median(in.plane(), guide.plane(), invalid, side, out.found.plane(), rows);
        });
        ASSERT_TRUE(same(out.found, out.expected)) << "round " << round << ", side " << side;
    }
}

TEST_P(CpuPost, SpeckleEqualsTheReference) {
    Random random(82);
    for (int round = 0; round < rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        const std::int16_t invalid = invalid_disparity(range);
        const Both<std::int16_t> disparity(disparities(random, size, range).plane());
        const int min_size = pick(random, 1, pick(random, 0, 1) == 0 ? 8 : 400);
        const int max_step = pick(random, 0, 9) == 0 ? 70000 : pick(random, 0, 60);
        const int min_texture = pick(random, 0, 2) > 0 ? pick(random, 1, 30) : 0;
        const TexturedPair pair(random, size);
        const RegionTest test{invalid, min_size, max_step, min_texture, pair.left.plane(), pair.right.plane()};
        std::vector<std::byte> memory(reference::speckle_scratch(size.width, size.height), std::byte{0x77});
        reference::speckle(disparity.expected.plane(), test, memory);
        const GuardedMemory<std::uint8_t> scratch(steps().speckle_scratch(size.width, size.height));
        std::fill_n(scratch.data(), scratch.size(), std::uint8_t{0xee});
        ShuffledWorkers several(pick(random, 2, 3), static_cast<unsigned>(round));
        Parallel& workers = round % 5 == 0 ? static_cast<Parallel&>(several) : serial_;
        steps().speckle(disparity.found.plane(), test,
                        std::as_writable_bytes(std::span(scratch.data(), scratch.size())), workers);
        ASSERT_TRUE(same(disparity.found, disparity.expected))
            << "round " << round << ", size " << min_size << ", step " << max_step << ", texture " << min_texture;
        ASSERT_TRUE(scratch.intact());
    }
}

class CpuSpeckle : public StepsOfInstructionSet {
protected:
    // For any number of bands that are worked on side by side.
    void expect_same(const Image<std::int16_t>& image, std::int16_t invalid, int min_size) {
        const int width = image.width();
        const int height = image.height();
        for (const int count : {1, 2, 5}) {
            const Both<std::int16_t> disparity(image.plane());
            std::vector<std::byte> memory(reference::speckle_scratch(width, height));
            reference::speckle(disparity.expected.plane(), {invalid, min_size, 1}, memory);
            std::vector<std::byte> scratch(steps().speckle_scratch(width, height));
            ShuffledWorkers workers(count, 7);
            steps().speckle(disparity.found.plane(), {invalid, min_size, 1}, scratch, workers);
            EXPECT_TRUE(same(disparity.found, disparity.expected)) << count << " workers";
        }
    }
};

// Of 128, runs end where words of bits do.
TEST_P(CpuSpeckle, EqualsTheReferenceOnCombsSpiralsAndChessboards) {
    constexpr std::int16_t invalid = -16;
    for (const int side : {128, 131}) {
        for (const Shape shape : speckle_shapes) {
            for (const int min_size : {2, 500, 8000, side * side, side * side + 1}) {
                const Image<std::int16_t> image = slope_in(shape, side, invalid);
                expect_same(image, invalid, min_size);
                ASSERT_FALSE(HasFailure()) << side << ", size " << min_size;
            }
        }
    }
}

TEST_P(CpuPost, InterpolateEqualsTheReference) {
    Random random(86);
    for (int round = 0; round < 2 * rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        Image<std::int16_t> start = disparities(random, size, range);
        const int percent = pick(random, 0, 100);
        for (std::int16_t& value : start.pixels()) {
            value = pick(random, 1, 100) <= percent ? invalid_disparity(range) : value;
        }
        const Image<std::int16_t> right = winners(random, size, range);
        const Both<std::int16_t> disparity(std::as_const(start).plane());
        std::vector<std::byte> memory(reference::interpolate_scratch(size.width, size.height), std::byte{0x33});
        reference::interpolate(disparity.expected.plane(), right.plane(), range, memory);
        const GuardedMemory<std::uint8_t> scratch(steps().interpolate_scratch(size.width, size.height));
        std::fill_n(scratch.data(), scratch.size(), std::uint8_t{0xcc});
        ShuffledWorkers several(pick(random, 2, 3), static_cast<unsigned>(round));
        Parallel& workers = round % 5 == 0 ? static_cast<Parallel&>(several) : serial_;
        steps().interpolate(disparity.found.plane(), right.plane(), range,
                            std::as_writable_bytes(std::span(scratch.data(), scratch.size())), workers);
        ASSERT_TRUE(same(disparity.found, disparity.expected)) << "round " << round << ", " << percent << " % rejected";
        ASSERT_TRUE(scratch.intact());
    }
}

TEST_P(CpuPost, FinishedConfidenceEqualsTheReference) {
    Random random(83);
    for (int round = 0; round < rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        const Image<std::int16_t> disparity = disparities(random, size, range);
        const Image<std::uint8_t> all = noise(random, size.width, size.height);
        const Both<std::uint8_t> confidence(all.plane());
        const bool calibrated = round % 2 == 0;
        reference::finish_confidence(disparity.plane(), invalid_disparity(range), calibrated,
                                     confidence.expected.plane(), {0, size.height});
        in_parts(size.height, [&](Rows rows) {
            steps().finish_confidence(disparity.plane(), invalid_disparity(range), calibrated, confidence.found.plane(),
                                      rows);
        });
        ASSERT_TRUE(same(confidence.found, confidence.expected)) << "round " << round;
    }
}

TEST_P(CpuPost, DepthEqualsTheReference) {
    Random random(84);
    for (int round = 0; round < 2 * rounds; ++round) {
        const Size size(random);
        const DisparityRange range = any_range(random);
        const DepthScale scale = any_scale(random);
        const Image<std::int16_t> disparity = disparities(random, size, range);
        const Both<std::uint16_t> depth(Image<std::uint16_t>(size.width, size.height, 4321).plane());
        reference::depth(disparity.plane(), invalid_disparity(range), scale, depth.expected.plane(), {0, size.height});
        in_parts(size.height, [&](Rows rows) {
            steps().depth(disparity.plane(), invalid_disparity(range), scale, depth.found.plane(), rows);
        });
        ASSERT_TRUE(same(depth.found, depth.expected))
            << "round " << round << ", k " << scale.k << ", offset " << scale.offset16;
    }
}

// Where a quotient in single precision is nearest to the next integer: exact multiples and one beside them.
TEST_P(CpuPost, DepthEqualsTheReferenceForEveryDisparityAtTheEdges) {
    const Image<std::int16_t> all = every_disparity();
    Random random(85);
    for (int round = 0; round < 60; ++round) {
        const DepthScale scale = scale_at_an_edge(random, round);
        const Both<std::uint16_t> depth(Image<std::uint16_t>(256, 256).plane());
        reference::depth(all.plane(), -16, scale, depth.expected.plane(), {0, 256});
        steps().depth(all.plane(), -16, scale, depth.found.plane(), {0, 256});
        ASSERT_TRUE(same(depth.found, depth.expected)) << "k " << scale.k << ", offset " << scale.offset16;
    }
}

TEST_P(CpuPost, DepthErrorEqualsTheReference) {
    Random random(86);
    for (int round = 0; round < 2 * rounds; ++round) {
        const Size size(random);
        expect_errors_of_the_reference(disparities(random, size, any_range(random)),
                                       noise(random, size.width, size.height, 0, pick(random, 0, 1) == 0 ? 1 : 255),
                                       any_error_scale(random));
        ASSERT_FALSE(HasFatalFailure()) << "round " << round;
    }
}

// Numerators around the limits of each way to divide, with disparities around the clamped ones.
TEST_P(CpuPost, DepthErrorEqualsTheReferenceForEveryDisparityAtTheEdges) {
    const Image<std::int16_t> all = every_disparity();
    const Image<std::uint8_t> measured(256, 256, 1);
    Random random(87);
    for (int round = 0; round < 80; ++round) {
        expect_errors_of_the_reference(all, measured, error_scale_at_an_edge(random, round));
        ASSERT_FALSE(HasFatalFailure()) << "round " << round;
    }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuSpeckle, testing::ValuesIn(cpu::instruction_sets()), name_of);
INSTANTIATE_TEST_SUITE_P(Cpu, CpuPost, testing::ValuesIn(cpu::instruction_sets()), name_of);

}  // namespace
}  // namespace disparityd::test
