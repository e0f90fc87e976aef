// SPDX-License-Identifier: Apache-2.0
#include "kernels/near_guard.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

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

/// Returns which blocks are rejected of a frame that is measured all over, where `columns` x `rows` blocks from (20, 2)
/// on are as bright as `luma` and the rest has 249.
std::vector<int> rejected_as_saturated(int columns, int rows, int luma, int level = 250) {
    Image<std::uint8_t> coarse(60, 8, 249);
    for (int y = 2; y < 2 + rows; ++y) {
        std::fill_n(&coarse.at(20, y), columns, static_cast<std::uint8_t>(luma));
    }
    Image<std::int16_t> disparity(238, 30, 128);
    Image<std::uint8_t> confidence(238, 30, 200);
    Image<std::uint16_t> depth(238, 30, 1000);
    Image<std::uint16_t> error(238, 30, 10);
    FrameView frame;
    frame.disparity = disparity.plane();
    frame.confidence = confidence.plane();
    frame.depth = depth.plane();
    frame.depth_error = error.plane();
    reject_saturated(coarse.plane(), level, range, frame);
    std::vector<int> blocks;
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 238; ++x) {
            const bool rejected = disparity.at(x, y) == invalid_disparity(range);
            EXPECT_EQ(confidence.at(x, y), rejected ? 0 : 200);
            EXPECT_EQ(depth.at(x, y), rejected ? 0 : 1000);
            EXPECT_EQ(error.at(x, y), rejected ? 0 : 10);
            if (rejected && x % near_block == 0 && y % near_block == 0) {
                blocks.push_back(60 * (y / near_block) + x / near_block);
            }
        }
    }
    return blocks;
}

TEST(NearGuard, RejectsASaturatedAreaOf25By3Blocks) {
    std::vector<int> area;
    for (int y = 2; y < 5; ++y) {
        for (int x = 20; x < 45; ++x) {
            area.push_back(60 * y + x);
        }
    }
    EXPECT_EQ(rejected_as_saturated(25, 3, 250), area);
    EXPECT_EQ(rejected_as_saturated(25, 3, 255), area);
}

TEST(NearGuard, KeepsASmallerOrDarkerArea) {
    EXPECT_EQ(rejected_as_saturated(24, 3, 255), std::vector<int>());
    EXPECT_EQ(rejected_as_saturated(25, 2, 255), std::vector<int>());
    EXPECT_EQ(rejected_as_saturated(40, 6, 250, 251), std::vector<int>());
}

TEST(NearGuard, ASaturatedAreaReachesTheEdgesOfTheImage) {
    EXPECT_EQ(rejected_as_saturated(40, 6, 255).size(), 40U * 6U);
    EXPECT_EQ(rejected_as_saturated(1, 1, 249, 249).size(), 60U * 8U);
}

TEST(NearGuard, EveryInstructionSetEqualsTheReference) {
    Pair pair = wall_and_near_thing();
    for (int y = 0; y < 40; ++y) {
        std::fill_n(&pair.left.at(0, y), 120, std::uint8_t{255});
    }
    for (const cpu::InstructionSet& instruction_set : cpu::instruction_sets()) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            for (const bool interpolate : {false, true}) {
                MatchOptions options = default_options(method, {-3, 16});
                options.post.near_guard = true;
                options.post.saturated_level = 250;
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
