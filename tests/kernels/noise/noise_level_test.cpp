// SPDX-License-Identifier: Apache-2.0
#include "kernels/noise/noise_level.h"

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/any_pair.h"

namespace disparityd::test {
namespace {

class NoiseLevels : public testing::TestWithParam<cpu::InstructionSet> {};

// With other frames in between, of other levels: nothing is left of them.
TEST_P(NoiseLevels, EqualTheReferenceFrameByFrame) {
    Random random(64);
    for (int round = 0; round < 12; ++round) {
        MatchOptions options = options_with_noise_levels(random);
        const int width = pick(random, 1, 90);
        const int height = pick(random, 1, 40);
        options.adaptive_noise = true;
        const auto matcher = cpu::create({width, height, options}, GetParam());
        ShuffledWorkers workers(pick(random, 1, 4), static_cast<unsigned>(random()));
        options.adaptive_noise = false;
        for (int frame = 0; frame < 4; ++frame) {
            const Pair pair(random, width, height);
            options.noise_level = pick(random, 0, last_noise_level);
            const Result expected = result_of("reference", pair, options);
            expect_result(result_of(*matcher, pair, workers, options.noise_level), expected, matcher->config(),
                          workers);
            const auto fixed = cpu::create({width, height, options}, GetParam());
            expect_result(result_of(*fixed, pair, workers), expected, fixed->config(), workers);
        }
    }
}

TEST_P(NoiseLevels, EqualTheReferenceOnHostileSizes) {
    Random random(65);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {3, 33}, {4, 4}, {5, 5}, {33, 3}, {64, 4}, {max_side, 2}}) {
        for (const DisparityRange range : {DisparityRange{0, 16}, {0, 256}, {-256, 256}, {256, 16}}) {
            MatchOptions options = options_with_noise_levels(random);
            options.range = range;
            options.noise_level = pick(random, 1, last_noise_level);
            const auto matcher = cpu::create({width, height, options}, GetParam());
            ShuffledWorkers workers(pick(random, 1, 3), static_cast<unsigned>(random()));
            expect_equal_to_reference(*matcher, Pair(random, width, height), workers);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, NoiseLevels, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

TEST(NoiseLevel, ChangesPenaltiesAndTheLeastUniqueness) {
    const MatchOptions options = preset_options(Preset::obstacles);
    EXPECT_EQ(at_noise_level(options, 0).sgm.p1, options.sgm.p1);
    for (const auto& [level, uniqueness] : {std::pair{0, 3}, {1, 3}, {2, 8}, {3, 16}}) {
        EXPECT_EQ(at_noise_level(options, level).post.uniqueness, uniqueness);
    }
    MatchOptions strict = options;
    strict.post.uniqueness = 20;
    EXPECT_EQ(at_noise_level(strict, 2).post.uniqueness, 20);
    EXPECT_EQ(at_noise_level(options, 1).sgm.p1, 20);
    EXPECT_EQ(at_noise_level(options, 3).sgm.p2, 63);
}

TEST(NoiseLevel, IsThereForFourAdaptivePathsOverTheGradientsCostOnly) {
    MatchOptions options = preset_options(Preset::obstacles);
    options.adaptive_noise = true;
    FrameView frame;
    frame.noise_level = 3;
    EXPECT_TRUE(adapts_to_noise(options));
    const auto spoilers = std::array<void (*)(MatchOptions&), 4>{
        [](MatchOptions& o) { o.method = Method::census; }, [](MatchOptions& o) { o.cost = CensusCost::census_9x7; },
        [](MatchOptions& o) { o.sgm.paths = 8; }, [](MatchOptions& o) { o.sgm.adaptive_p2 = false; }};
    for (const auto spoil : spoilers) {
        MatchOptions other = options;
        spoil(other);
        EXPECT_EQ(validate(other), "") << "it has no effect";
        EXPECT_FALSE(adapts_to_noise(other));
        EXPECT_EQ(noise_level_of(other, frame), 0);
        other.noise_level = 1;
        EXPECT_EQ(validate(other).empty(), other.method != Method::sgm);
    }
}

TEST(NoiseLevel, OfAFrameCountsWhereItIsToAdapt) {
    MatchOptions options = preset_options(Preset::obstacles);
    options.adaptive_noise = false;
    FrameView frame;
    frame.noise_level = 2;
    EXPECT_EQ(noise_level_of(options, frame), 0);
    options.noise_level = 1;
    EXPECT_EQ(noise_level_of(options, frame), 1);
    options.adaptive_noise = true;
    EXPECT_EQ(noise_level_of(options, frame), 2);
    options.noise_level = 3;
    EXPECT_EQ(noise_level_of(options, frame), 3) << "the least";
}

}  // namespace
}  // namespace disparityd::test
