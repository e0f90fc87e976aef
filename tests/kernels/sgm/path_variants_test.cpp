// SPDX-License-Identifier: Apache-2.0
//
// SGM in all its variants: 8 or 4 paths, sums in bytes or, for a large P2, in words.
#include <bit>
#include <tuple>

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/sgm/path_kernels.h"
#include "tests/kernels/sgm/sgm_case.h"

namespace disparityd::test {
namespace {

struct Variant {
    const char* name;
    int paths;
    int min_p2;
    int max_p2;
};

constexpr Variant variants[] = {{"EightPaths", 8, 2, cpu::max_byte_p2},
                                {"EightPathsU16Sums", 8, cpu::max_byte_p2 + 1, 193},
                                {"FourPaths", 4, 2, cpu::max_byte_p2},
                                {"FourPathsU16Sums", 4, cpu::max_byte_p2 + 1, 193}};

// What a failure shows; found by GoogleTest.
void PrintTo(const Variant& variant, std::ostream* out) {
    *out << variant.name;
}

class PathVariants : public testing::TestWithParam<std::tuple<cpu::InstructionSet, Variant>> {
protected:
    std::int64_t target() const { return std::get<0>(GetParam()).target; }
    const Variant& variant() const { return std::get<1>(GetParam()); }
    MatchOptions options(Random& random) const {
        return random_sgm_options(random, variant().paths, variant().min_p2, variant().max_p2);
    }
};

TEST_P(PathVariants, EqualTheReference) {
    Random random(70);
    for (int round = 0; round < 60; ++round) {
        const int width = pick(random, 1, round % 2 == 0 ? 200 : 40);
        ShuffledWorkers workers(pick(random, 1, 8), static_cast<unsigned>(random()));
        random_case(random, width, pick(random, 1, 14), options(random))
            .expect_from(target(), round % 3 == 0 ? in_cache : 0, workers);
    }
}

TEST_P(PathVariants, EqualTheReferenceForEveryNumberOfDisparities) {
    Random random(71);
    Serial serial;
    for (int disparities = 16; disparities <= max_disparities; disparities += 16) {
        for (const int first : {0, -disparities / 2}) {
            MatchOptions how = options(random);
            how.range = {first, disparities};
            const SgmCase images = random_case(random, 130, 6, how);
            images.expect_from(target(), 0, serial);
            images.expect_from(target(), in_cache, serial);
        }
    }
}

TEST_P(PathVariants, EqualTheReferenceOnHostileSizes) {
    Random random(72);
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
            MatchOptions how = options(random);
            how.range = range;
            random_case(random, width, height, how).expect_from(target(), 0, serial);
        }
    }
}

TEST(PairOfOpposites, HasTheLargestCost) {
    Pair pair = pair_of_opposites(140, 8);
    Image<std::uint64_t> left(140, 8), right(140, 8);
    reference::census(pair.left.plane(), left.plane(), pair.left.rows());
    reference::census(pair.right.plane(), right.plane(), pair.right.rows());
    EXPECT_EQ(std::popcount(left.at(70, 4) ^ right.at(60, 4)), 62);
}

TEST_P(PathVariants, TheLargestPenaltiesAndCostsDoNotOverflow) {
    Serial serial;
    MatchOptions how;
    how.sgm.paths = variant().paths;
    how.sgm.p2 = variant().max_p2;
    const Pair pair = pair_of_opposites(140, 8);
    for (const int p1 : {1, 10, how.sgm.p2 - 1}) {
        for (const int disparities : {16, 48, 64, 80, 128, 144, 256}) {
            how.sgm.p1 = p1;
            how.range = {0, disparities};
            SgmCase(pair, how).expect_from(target(), 0, serial);
        }
    }
}

TEST_P(PathVariants, ManyWorkersEqualTheReference) {
    Random random(74);
    for (const int count : {3, 8, 32}) {
        ShuffledWorkers workers(count, static_cast<unsigned>(random()));
        random_case(random, pick(random, 100, 300), pick(random, 10, 40), options(random))
            .expect_from(target(), 0, workers);
    }
}

TEST_P(PathVariants, WholeMatcherEqualsTheReference) {
    Random random(75);
    Serial serial;
    for (int round = 0; round < 4; ++round) {
        const MatchOptions how = options(random);
        const Pair pair(random, pick(random, 1, 150), pick(random, 1, 20));
        const auto matcher = cpu::create({pair.width(), pair.height(), how}, std::get<0>(GetParam()));
        expect_equal_to_reference(*matcher, pair, serial);
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, PathVariants,
                         testing::Combine(testing::ValuesIn(cpu::instruction_sets()), testing::ValuesIn(variants)),
                         [](const auto& instance) {
                             return std::get<0>(instance.param).name + "_" + std::get<1>(instance.param).name;
                         });

}  // namespace
}  // namespace disparityd::test
