// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/sgm_sweeps.h"
#include "tests/kernels/guarded.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

using Bytes = Image<std::uint8_t>;

// Images that have broken vector code before: all equal, two values, extremes, noise, a shifted copy.
struct Pair {
    Pair(Random& random, int width, int height) : left(width, height), right(width, height) {
        const int kind = pick(random, 0, 4);
        if (kind == 0) {
            const auto value = static_cast<std::uint8_t>(pick(random, 0, 255));
            left = Bytes(width, height, value);
            right = Bytes(width, height, value);
            return;
        }
        left = noise(random, width, height, 0, kind == 1 ? 1 : 255);
        right = kind == 2 ? shifted(random, left, pick(random, -20, 20)) : noise(random, width, height);
        if (kind == 3) {
            for (Bytes* image : {&left, &right}) {
                for (std::uint8_t& pixel : image->pixels()) {
                    pixel = pixel < 128 ? 0 : 255;
                }
            }
        }
    }
    Bytes left, right;
};

struct Outputs {
    Outputs(int width, int height)
        : disparity(width, height), confidence(width, height), winner(width, height), right_winner(width, height) {}

    cpu::WinnerPlanes view() const {
        return {disparity.plane(), confidence.plane(), winner.plane(), right_winner.plane()};
    }
    bool intact() const {
        return disparity.intact() && confidence.intact() && winner.intact() && right_winner.intact();
    }

    GuardedPlane<std::int16_t> disparity;
    GuardedPlane<std::uint8_t> confidence;
    GuardedPlane<std::int16_t> winner;
    GuardedPlane<std::int16_t> right_winner;
};

void run_reference(const Pair& pair, const MatchOptions& options, const Outputs& out) {
    const int width = pair.left.width();
    const int height = pair.left.height();
    const Rows rows{0, height};
    Image<std::uint64_t> left(width, height);
    Image<std::uint64_t> right(width, height);
    reference::census(pair.left.plane(), left.plane(), rows);
    reference::census(pair.right.plane(), right.plane(), rows);
    const std::size_t candidates = left.pixels().size() * static_cast<std::size_t>(options.range.count);
    std::vector<std::uint8_t> costs(candidates);
    std::vector<std::uint16_t> sums(candidates);
    std::vector<std::byte> scratch(reference::aggregate_scratch(width, height, options.range.count));
    const Volume<std::uint8_t> cost_volume{costs.data(), width, height, options.range.count};
    const Volume<std::uint16_t> sum_volume{sums.data(), width, height, options.range.count};
    Serial serial;
    reference::matching_cost(left.plane(), right.plane(), options.range, cost_volume, rows);
    reference::aggregate(cost_volume, pair.left.plane(), options.sgm, sum_volume, scratch, serial);
    reference::winner_left<std::uint16_t>(sum_volume, options.range, options.post.subpixel, out.winner.plane(),
                                          out.disparity.plane(), rows);
    reference::winner_right<std::uint16_t>(sum_volume, options.range, out.right_winner.plane(), rows);
    reference::local_extrema<std::uint16_t>(sum_volume, options.range, options.post, out.winner.plane(),
                                            out.disparity.plane(), out.confidence.plane(), rows);
}

template <typename T>
int differences(Plane<T> a, Plane<T> b) {
    int count = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            count += a.at(x, y) == b.at(x, y) ? 0 : 1;
        }
    }
    return count;
}

MatchOptions byte_sum_options(Random& random) {
    MatchOptions options;
    options.range = {pick(random, 0, 3) == 0 ? pick(random, -256, 256) : pick(random, -20, 20),
                     16 * pick(random, 1, 16)};
    options.sgm.p2 = pick(random, 2, cpu::max_byte_p2);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    return options;
}

class EveryInstructionSet : public testing::TestWithParam<cpu::InstructionSet> {
protected:
    // 0 has volumes written past the caches, 1 GiB within.
    void compare(const Pair& pair, const MatchOptions& options, std::size_t cache_bytes, Parallel& workers) {
        const int width = pair.left.width();
        const int height = pair.left.height();
        const cpu::SgmSweeps sweeps(width, height, options, GetParam().target, cache_bytes);
        const GuardedMemory<std::uint8_t> census(sweeps.census_bytes());
        const std::span<std::byte> planes(reinterpret_cast<std::byte*>(census.data()), census.size());
        const Outputs found(width, height);
        const Outputs expected(width, height);
        run_reference(pair, options, expected);
        sweeps.census(pair.left.plane(), pair.right.plane(), planes, workers);
        sweeps.match(planes, pair.left.plane(), found.view(), workers);
        EXPECT_TRUE(census.intact());
        EXPECT_TRUE(found.intact());
        EXPECT_EQ(differences(found.winner.plane(), expected.winner.plane()), 0);
        EXPECT_EQ(differences(found.right_winner.plane(), expected.right_winner.plane()), 0);
        EXPECT_EQ(differences(found.disparity.plane(), expected.disparity.plane()), 0);
        EXPECT_EQ(differences(found.confidence.plane(), expected.confidence.plane()), 0);
        ASSERT_FALSE(HasFailure()) << width << "x" << height << ", D " << options.range.count << " from "
                                   << options.range.first << ", P1 " << options.sgm.p1 << ", P2 " << options.sgm.p2
                                   << ", " << workers.workers() << " workers, cache " << cache_bytes;
    }
};

TEST_P(EveryInstructionSet, SgmEqualsTheReference) {
    Random random(40);
    for (int round = 0; round < 60; ++round) {
        const int width = pick(random, 1, round % 2 == 0 ? 200 : 40);
        const Pair pair(random, width, pick(random, 1, 14));
        const int count = pick(random, 1, 8);
        ShuffledWorkers workers(count, static_cast<unsigned>(random()));
        compare(pair, byte_sum_options(random), round % 3 == 0 ? 0 : std::size_t{1} << 30, workers);
    }
}

TEST_P(EveryInstructionSet, SgmEqualsTheReferenceForEveryNumberOfDisparities) {
    Random random(41);
    Serial serial;
    for (int disparities = 16; disparities <= max_disparities; disparities += 16) {
        for (const int first : {0, -disparities / 2}) {
            MatchOptions options = byte_sum_options(random);
            options.range = {first, disparities};
            compare(Pair(random, 130, 6), options, 0, serial);
        }
    }
}

TEST_P(EveryInstructionSet, SgmEqualsTheReferenceOnHostileSizes) {
    Random random(42);
    Serial serial;
    for (const auto& [width, height] : {std::pair{1, 1},
                                        {1, 9},
                                        {9, 1},
                                        {2, 2},
                                        {15, 3},
                                        {16, 2},
                                        {17, 3},
                                        {31, 2},
                                        {32, 3},
                                        {33, 2},
                                        {48, 4},
                                        {49, 3},
                                        {63, 2},
                                        {64, 3},
                                        {65, 2},
                                        {96, 5}}) {
        for (const DisparityRange range : {DisparityRange{0, 16}, {0, 256}, {-256, 256}, {256, 16}, {-256, 16}}) {
            MatchOptions options = byte_sum_options(random);
            options.range = range;
            compare(Pair(random, width, height), options, 0, serial);
        }
    }
}

TEST_P(EveryInstructionSet, TheLargestPenaltiesAndCostsDoNotOverflow) {
    Random random(43);
    Serial serial;
    MatchOptions options;
    options.sgm.p2 = cpu::max_byte_p2;
    for (const int p1 : {1, 10, cpu::max_byte_p2 - 1}) {
        for (const int disparities : {16, 64, 80, 128, 256}) {
            options.sgm.p1 = p1;
            options.range = {0, disparities};
            Pair pair(random, 140, 8);
            // Census words that differ in as many bits as can be: rising on the left, falling on the right.
            for (int x = 0; x < 140; ++x) {
                for (int y = 0; y < 8; ++y) {
                    pair.left.at(x, y) = static_cast<std::uint8_t>(x + y);
                    pair.right.at(x, y) = static_cast<std::uint8_t>(255 - x - y);
                }
            }
            compare(pair, options, 0, serial);
        }
    }
}

TEST_P(EveryInstructionSet, WholeMatcherEqualsTheReferenceForAnyMethod) {
    Random random(44);
    Serial serial;
    for (int round = 0; round < 12; ++round) {
        MatchOptions options = byte_sum_options(random);
        options.method = static_cast<Method>(round % 3);
        options.post.interpolate = pick(random, 0, 1) == 1;
        const int width = pick(random, 1, 150);
        const int height = pick(random, 1, 20);
        const Pair pair(random, width, height);
        const auto reference = backend("reference").create({width, height, options});
        const auto matcher = cpu::create({width, height, options}, GetParam());
        Frame expected(*reference, pair.left, pair.right);
        Frame found(*matcher, pair.left, pair.right);
        match(*reference, expected.view, serial);
        match(*matcher, found.view, serial);
        ASSERT_EQ(found.disparity.pixels(), expected.disparity.pixels()) << width << "x" << height;
        ASSERT_EQ(found.confidence.pixels(), expected.confidence.pixels());
        ASSERT_EQ(found.depth.pixels(), expected.depth.pixels());
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, EveryInstructionSet, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

}  // namespace
}  // namespace disparityd::test
