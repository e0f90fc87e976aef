// SPDX-License-Identifier: Apache-2.0
#include "kernels/near_guard.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/any_pair.h"

namespace disparityd::test {
namespace {

constexpr DisparityRange range{0, 16};

MatchOptions guarded(DisparityRange of = range) {
    return preset_options(Preset::obstacles, of);
}

/// A wall at disparity 8, and from column 150 on something at 48, before it on the left: both in noise.
Pair wall_and_near_thing() {
    Random random(31);
    Pair pair{noise(random, 241, 63), noise(random, 241, 63)};
    for (int y = 0; y < pair.height(); ++y) {
        for (int x = 8; x < pair.width(); ++x) {
            const int d = x < 150 ? 8 : 48;
            pair.right.at(x - d, y) = pair.left.at(x, y);
        }
    }
    return pair;
}

Frame matched(std::string_view back_end, const MatchOptions& options, const Pair& pair) {
    Serial serial;
    const auto matcher = backend(back_end).create({pair.width(), pair.height(), options});
    Frame frame(*matcher, pair.left, pair.right);
    match_pair(*matcher, frame.view, serial);
    return frame;
}

TEST(NearGuard, RejectsAndTellsWhatIsNearerThanTheRange) {
    const Pair pair = wall_and_near_thing();
    const Frame frame = matched("reference", guarded(), pair);
    int near = 0;
    int measured = 0;
    for (int y = 0; y < pair.height(); ++y) {
        for (int x = 0; x < pair.width(); ++x) {
            const int value = frame.near.at(x / near_block, y / near_block);
            if (value != not_near) {
                ASSERT_NEAR(value, 16 * 48, 24) << x << "," << y;
                ASSERT_EQ(frame.disparity.at(x, y), invalid_disparity(range)) << x << "," << y;
                ASSERT_EQ(frame.confidence.at(x, y), 0);
                ASSERT_EQ(frame.depth.at(x, y), 0);
                ASSERT_EQ(frame.depth_error.at(x, y), 0);
            }
            near += static_cast<int>(x >= 156 && value != not_near);
            measured += static_cast<int>(x >= 20 && x < 90 && std::abs(frame.disparity.at(x, y) - 8 * 16) <= 8);
        }
    }
    EXPECT_GT(near, 80 * 63 * 9 / 10);
    EXPECT_GT(measured, 70 * 63 * 9 / 10);
}

TEST(NearGuard, ChangesNothingElsewhere) {
    const Pair pair = wall_and_near_thing();
    MatchOptions options = guarded();
    const Frame with = matched("reference", options, pair);
    options.post.near_guard = false;
    const Frame without = matched("reference", options, pair);
    for (int y = 0; y < pair.height(); ++y) {
        for (int x = 0; x < pair.width(); ++x) {
            if (with.near.at(x / near_block, y / near_block) == not_near) {
                ASSERT_EQ(with.disparity.at(x, y), without.disparity.at(x, y));
                ASSERT_EQ(with.confidence.at(x, y), without.confidence.at(x, y));
                ASSERT_EQ(with.depth.at(x, y), without.depth.at(x, y));
                ASSERT_EQ(with.depth_error.at(x, y), without.depth_error.at(x, y));
            }
        }
    }
    // Who has it off has no such plane.
    EXPECT_EQ(without.near.pixels(), std::vector<std::int16_t>(without.near.pixels().size(), 3210));
}

TEST(NearGuard, TellsNothingThatTheRangeReaches) {
    const Frame frame = matched("reference", guarded({0, 64}), wall_and_near_thing());
    EXPECT_EQ(frame.near.pixels(), std::vector<std::int16_t>(frame.near.pixels().size(), not_near));
}

TEST(NearGuard, ReachesTwiceTheLargestDisparityAndAllOfTheRange) {
    struct Case {
        DisparityRange range;
        int first;
        int count;
    };
    for (const Case& expected : {Case{{0, 16}, 0, 64},
                                 {{0, 64}, 0, 64},
                                 {{0, 128}, 0, 64},
                                 {{0, 256}, 0, 128},
                                 {{-5, 80}, -2, 64},
                                 {{-256, 256}, -64, 80},
                                 {{256, 16}, 64, 80},
                                 {{256, 256}, 64, 192}}) {
        const MatcherConfig coarse = coarse_config({1281, 720, guarded(expected.range)});
        EXPECT_EQ(coarse.options.range.first, expected.first) << expected.range.first << " " << expected.range.count;
        EXPECT_EQ(coarse.options.range.count, expected.count) << expected.range.first << " " << expected.range.count;
        EXPECT_EQ(validate(coarse.options), "");
        EXPECT_EQ(coarse.width, 321);
        EXPECT_EQ(coarse.height, 180);
        EXPECT_FALSE(coarse.options.post.near_guard);
    }
}

TEST(NearGuard, EveryInstructionSetEqualsTheReference) {
    const Pair pair = wall_and_near_thing();
    for (const cpu::InstructionSet& instruction_set : cpu::instruction_sets()) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            for (const bool interpolate : {false, true}) {
                MatchOptions options = default_options(method, {-3, 16});
                options.post.near_guard = true;
                options.post.interpolate = interpolate;
                const auto matcher = cpu::create({pair.width(), pair.height(), options}, instruction_set);
                ShuffledWorkers workers(3, 32);
                expect_equal_to_reference(*matcher, pair, workers);
            }
        }
    }
}

TEST(NearGuard, TheLastStageHasAStepMore) {
    Serial serial;
    const Pair pair = wall_and_near_thing();
    for (const std::string_view name : {"reference", "cpu"}) {
        const auto matcher = backend(name).create({pair.width(), pair.height(), guarded()});
        const StageInfo& last = matcher->stages().back();
        EXPECT_EQ(last.steps.back(), "near-guard") << name;
        EXPECT_TRUE(matcher->config().options.post.near_guard) << name;
        Frame frame(*matcher, pair.left, pair.right);
        std::vector<std::chrono::nanoseconds> times(last.steps.size());
        match_pair(*matcher, frame.view, serial);
        matcher->run(static_cast<int>(matcher->stages().size()) - 1, frame.view, serial, times);
        EXPECT_GT(times.back().count(), 0) << name;
    }
}

}  // namespace
}  // namespace disparityd::test
