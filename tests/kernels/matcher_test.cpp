// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "tests/kernels/any_pair.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

// Noise so that every window is unlike every other.
Pair shifted_pair(Random& random, int width, int height, int d) {
    const Bytes left = noise(random, width, height);
    return {left, shifted(random, left, d)};
}

class EveryMethod : public testing::TestWithParam<Method> {};

TEST_P(EveryMethod, AShiftedImageGivesTheShiftEverywhereItCan) {
    Random random(20);
    Serial serial;
    for (const auto& [first, d] : {std::pair{0, 5}, {0, 0}, {0, 31}, {-12, -9}, {-12, 4}, {-40, -20}, {7, 13}}) {
        MatchOptions options = default_options(GetParam(), {first, 32});
        options.post.subpixel = false;
        options.post.interpolate = false;
        const auto matcher = backend("cpu").create({70, 30, options});
        const Pair pair = shifted_pair(random, 70, 30, d);
        Frame frame(*matcher, pair.left, pair.right);
        match_pair(*matcher, frame.view, serial);
        int possible = 0;
        int missed = 0;
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 70; ++x) {
                // The windows of both pixels lie inside what both images show.
                const bool can = x - d >= 4 && x - d < 66 && x >= 4 && x < 66 && y >= 3 && y < 27;
                if (can) {
                    ++possible;
                    missed += frame.disparity.at(x, y) == 16 * d && frame.confidence.at(x, y) > 0 ? 0 : 1;
                }
                if (x - d < 0 || x - d >= 70) {
                    ASSERT_NE(frame.disparity.at(x, y), 16 * d) << "the match lies outside the right image";
                }
            }
        }
        // Census words of single pixels that are brighter or darker than all around them are alike.
        EXPECT_LE(missed, GetParam() == Method::census ? possible / 20 : 0) << "of " << possible << ", first " << first;
    }
}

TEST_P(EveryMethod, ConfidenceAndDepthFollowTheDisparity) {
    Random random(21);
    Serial serial;
    for (const bool interpolate : {false, true}) {
        MatchOptions options = default_options(GetParam(), {-3, 16});
        options.post.interpolate = interpolate;
        const auto matcher = backend("cpu").create({60, 25, options});
        const Pair pair = shifted_pair(random, 60, 25, 4);
        Frame frame(*matcher, pair.left, pair.right);
        match_pair(*matcher, frame.view, serial);
        int interpolated = 0;
        for (int y = 0; y < 25; ++y) {
            for (int x = 0; x < 60; ++x) {
                const bool rejected = frame.disparity.at(x, y) == invalid_disparity(options.range);
                const int d = frame.disparity.at(x, y) + 3;
                // 64/256 px are 4/16 px.
                const int error = d <= 0 ? 65535 : std::clamp((4 * 1600000 + d * d / 2) / (d * d), 1, 65535);
                EXPECT_EQ(frame.depth_error.at(x, y), frame.confidence.at(x, y) == 0 ? 0 : error);
                EXPECT_EQ(frame.depth.at(x, y), rejected ? 0 : d <= 0 ? 65535 : std::min((1600000 + d / 2) / d, 65535));
                if (rejected) {
                    EXPECT_EQ(frame.confidence.at(x, y), 0);
                }
                interpolated += !rejected && frame.confidence.at(x, y) == 0 ? 1 : 0;
            }
        }
        EXPECT_EQ(interpolated > 0, interpolate);
    }
}

TEST_P(EveryMethod, NothingIsMeasuredOnConstantImagesWhereAllCandidatesAreEqual) {
    Serial serial;
    for (const int grey : {0, 128, 255}) {
        const auto matcher = backend("cpu").create({60, 20, default_options(GetParam(), {0, 16})});
        const Image<std::uint8_t> image(60, 20, static_cast<std::uint8_t>(grey));
        Frame frame(*matcher, image, image);
        match_pair(*matcher, frame.view, serial);
        for (int y = 0; y < 20; ++y) {
            for (int x = 0; x < 60; ++x) {
                EXPECT_EQ(frame.disparity.at(x, y), -16);
                EXPECT_EQ(frame.confidence.at(x, y), 0);
                EXPECT_EQ(frame.depth.at(x, y), 0);
            }
        }
    }
}

/// Two images of noise of which only the left `columns` of the right one show what the left one does, 2 px moved.
Pair partly_alike(Random& random, int columns) {
    Pair pair{noise(random, 70, 30), noise(random, 70, 30)};
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < std::min(columns, 68); ++x) {
            pair.right.at(x, y) = pair.left.at(x + 2, y);
        }
    }
    return pair;
}

TEST_P(EveryMethod, NothingIsFilledInWhereLessThanATwentiethIsMeasured) {
    Serial serial;
    MatchOptions options = default_options(GetParam(), {0, 16});
    options.post.uniqueness = 10;
    options.post.speckle_size = 30;
    for (const char* name : {"reference", "cpu"}) {
        Random random(24);
        int filled = 0;
        int left_alone = 0;
        for (int columns = 0; columns <= 70; columns += 5) {
            const Pair pair = partly_alike(random, columns);
            const auto disparities = [&](bool interpolate) {
                options.post.interpolate = interpolate;
                const auto matcher = backend(name).create({70, 30, options});
                Frame frame(*matcher, pair.left, pair.right);
                match_pair(*matcher, frame.view, serial);
                return frame.disparity.pixels();
            };
            const auto measured = disparities(false);
            const auto rejected = std::count(measured.begin(), measured.end(), invalid_disparity(options.range));
            const bool enough = 20 * (70 * 30 - rejected) >= 70 * 30;
            const auto found = disparities(true);
            EXPECT_EQ(found != measured, enough) << name << ", " << columns << " columns, " << rejected << " rejected";
            ++(enough ? filled : left_alone);
        }
        EXPECT_GT(filled, 2) << name;
        EXPECT_GT(left_alone, 0) << name;
    }
}

TEST_P(EveryMethod, OptionalPlanesMayBeMissing) {
    Random random(22);
    Serial serial;
    const auto matcher = backend("cpu").create({30, 20, default_options(GetParam(), {0, 16})});
    const Pair pair = shifted_pair(random, 30, 20, 2);
    Frame with(*matcher, pair.left, pair.right);
    Frame without(*matcher, pair.left, pair.right);
    without.view.depth = {};
    without.view.depth_error = {};
    match_pair(*matcher, with.view, serial);
    match_pair(*matcher, without.view, serial);
    EXPECT_EQ(with.disparity.pixels(), without.disparity.pixels());
    EXPECT_EQ(without.depth.pixels(), std::vector<std::uint16_t>(600, 4321));
    EXPECT_EQ(without.depth_error.pixels(), std::vector<std::uint16_t>(600, 5432));
}

TEST_P(EveryMethod, StagesStartWithRectifyAndTimeEveryStep) {
    Random random(23);
    Serial serial;
    const auto matcher = backend("cpu").create({24, 10, default_options(GetParam(), {0, 16})});
    EXPECT_EQ(matcher->stages().front().kind, StageKind::rectify);
    EXPECT_EQ(matcher->stages().back().kind, StageKind::post_process);
    EXPECT_EQ(to_string(StageKind::post_process), "post-process");
    Image<std::uint8_t> bytes = noise(random, 2 * 2 * 30, 12);
    const Rectifier rectifier{false, {}, {}, 6, 2};
    Frame frame(*matcher, Image<std::uint8_t>(24, 10), Image<std::uint8_t>(24, 10));
    Image<std::uint8_t> colour(3 * 24, 10, 1);
    Image<std::uint8_t> right_colour(3 * 24, 10, 2);
    frame.view.raw = {bytes.plane().data, PixelFormat::yuyv, 30, 12, bytes.width()};
    frame.view.rectifier = &rectifier;
    frame.view.left_colour = colour.plane();
    frame.view.right_colour = right_colour.plane();
    for (std::size_t i = 0; i < matcher->stages().size(); ++i) {
        std::vector<std::chrono::nanoseconds> times(matcher->stages()[i].steps.size(), std::chrono::nanoseconds(-1));
        ASSERT_FALSE(times.empty());
        matcher->run(static_cast<int>(i), frame.view, serial, times);
        for (const auto time : times) {
            EXPECT_GE(time.count(), 0);
        }
    }
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 24; ++x) {
            ASSERT_EQ(frame.left.at(x, y), bytes.at(2 * (x + 6), y + 2));
            ASSERT_EQ(frame.right.at(x, y), bytes.at(2 * (x + 36), y + 2));
        }
    }
    Image<std::uint8_t> expected(3 * 24, 10);
    reference::rectify_colour(frame.view.raw, Eye::left, rectifier, expected.plane(), expected.rows());
    EXPECT_EQ(colour.pixels(), expected.pixels());
    reference::rectify_colour(frame.view.raw, Eye::right, rectifier, expected.plane(), expected.rows());
    EXPECT_EQ(right_colour.pixels(), expected.pixels());
}

TEST_P(EveryMethod, ARegionOutsideTheFrameIsRefused) {
    Serial serial;
    const auto matcher = backend("cpu").create({24, 10, default_options(GetParam(), {0, 16})});
    Image<std::uint8_t> bytes(60, 12);
    Frame frame(*matcher, Image<std::uint8_t>(24, 10), Image<std::uint8_t>(24, 10));
    frame.view.raw = {bytes.plane().data, PixelFormat::grey8, 30, 12, 60};
    std::chrono::nanoseconds time{};
    constexpr int most = std::numeric_limits<int>::max();
    for (const auto& [x, y] : {std::pair{7, 0}, {0, 3}, {-1, 0}, {0, -1}, {most, 0}, {0, most}}) {
        const Rectifier rectifier{false, {}, {}, x, y};
        frame.view.rectifier = &rectifier;
        EXPECT_THROW(matcher->run(0, frame.view, serial, {&time, 1}), std::invalid_argument);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::Values(Method::sad, Method::census, Method::sgm),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

class EveryInstructionSet : public testing::TestWithParam<cpu::InstructionSet> {};

TEST_P(EveryInstructionSet, EqualsTheReferenceForAnyOptionsAndWorkers) {
    Random random(24);
    for (int round = 0; round < 40; ++round) {
        const int width = pick(random, 1, round % 4 == 0 ? 150 : 70);
        const int height = pick(random, 1, 40);
        const Pair pair =
            round % 2 == 0 ? Pair(random, width, height) : shifted_pair(random, width, height, pick(random, -5, 20));
        const MatchOptions options = any_options(random);
        const auto matcher = cpu::create({pair.width(), pair.height(), options}, GetParam());
        const Result expected = result_of("reference", pair, options);
        for (const int count : {1, 2, 3, 7}) {
            ShuffledWorkers workers(count, static_cast<unsigned>(random()));
            expect_result(result_of(*matcher, pair, workers), expected, matcher->config(), workers);
        }
    }
}

TEST_P(EveryInstructionSet, EqualsTheReferenceOnHostileSizes) {
    Random random(25);
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {15, 9}, {33, 3}, {3, 33}, {63, 5}, {64, 4}}) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            for (const DisparityRange range : {DisparityRange{0, 16}, {0, 256}, {-256, 256}, {256, 16}, {-256, 16}}) {
                MatchOptions options = any_options(random);
                options.method = method;
                options.range = range;
                const auto matcher = cpu::create({width, height, options}, GetParam());
                ShuffledWorkers workers(pick(random, 2, 5), static_cast<unsigned>(random()));
                expect_equal_to_reference(*matcher, Pair(random, width, height), workers);
            }
        }
    }
}

// Rows as long as they may be, where arrays of a fixed size are full.
TEST_P(EveryInstructionSet, EqualsTheReferenceOnTheLongestRows) {
    Random random(28);
    struct Case {
        int width;
        DisparityRange range;
    };
    for (const auto& [width, range] : {Case{max_side, {256, 256}},
                                       {max_side, {-256, 256}},
                                       {max_side - 1, {0, 256}},
                                       {max_side, {256, 16}},
                                       {max_side, {-256, 16}}}) {
        for (const auto& [method, p2] :
             {std::pair{Method::sad, 2}, {Method::census, 2}, {Method::sgm, 63}, {Method::sgm, 193}}) {
            MatchOptions options = any_options(random);
            options.method = method;
            options.range = range;
            options.sgm.p2 = p2;
            options.sgm.p1 = p2 / 2;
            options.sgm.p2_min = 0;
            options.post.left_right_check = true;
            options.post.interpolate = true;
            const auto matcher = cpu::create({width, 2, options}, GetParam());
            ShuffledWorkers workers(2, static_cast<unsigned>(random()));
            expect_equal_to_reference(*matcher, Pair(random, width, 2), workers);
        }
    }
}

// The largest sums of absolute differences that there can be, of every candidate.
TEST_P(EveryInstructionSet, EqualsTheReferenceOnBlackBesideWhite) {
    Random random(29);
    for (const DisparityRange range : {DisparityRange{0, 16}, {-7, 64}, {3, 256}}) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            MatchOptions options = any_options(random);
            options.method = method;
            options.range = range;
            const auto matcher = cpu::create({90, 21, options}, GetParam());
            Serial serial;
            expect_equal_to_reference(*matcher, {Bytes(90, 21, 0), Bytes(90, 21, 255)}, serial);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CpuKernels, EveryInstructionSet, testing::ValuesIn(cpu::instruction_sets()),
                         [](const auto& set) { return set.param.name; });

TEST(CpuBackend, NothingIsLeftFromTheFrameBefore) {
    Random random(26);
    Serial serial;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        MatchOptions options = default_options(method, {0, 16});
        options.post.speckle_size = 20;
        options.post.interpolate = true;
        const auto matcher = backend("cpu").create({33, 21, options});
        const Pair one = shifted_pair(random, 33, 21, 3);
        const Pair other = shifted_pair(random, 33, 21, 9);
        Frame first(*matcher, one.left, one.right);
        match_pair(*matcher, first.view, serial);
        Frame second(*matcher, other.left, other.right);
        match_pair(*matcher, second.view, serial);
        Frame again(*matcher, one.left, one.right);
        match_pair(*matcher, again.view, serial);
        EXPECT_EQ(first.disparity.pixels(), again.disparity.pixels());
        EXPECT_EQ(first.confidence.pixels(), again.confidence.pixels());
        EXPECT_NE(first.disparity.pixels(), second.disparity.pixels());
    }
}

// Stages of different frames overlap in a pipeline: match of the next frame runs before post-process of this one.
TEST(CpuBackend, WhatTravelsWithAFrameIsItsOwn) {
    Random random(27);
    Serial serial;
    MatchOptions options = default_options(Method::sgm, {0, 16});
    options.post.interpolate = true;
    const auto matcher = backend("cpu").create({33, 21, options});
    const Pair one = shifted_pair(random, 33, 21, 3);
    const Pair other = shifted_pair(random, 33, 21, 9);
    Frame alone(*matcher, one.left, one.right);
    match_pair(*matcher, alone.view, serial);

    Frame first(*matcher, one.left, one.right);
    Frame second(*matcher, other.left, other.right);
    std::array<std::chrono::nanoseconds, 8> times{};
    const auto run = [&](int stage, Frame& frame) {
        const std::size_t steps = matcher->stages()[static_cast<std::size_t>(stage)].steps.size();
        matcher->run(stage, frame.view, serial, std::span(times).first(steps));
    };
    run(1, first);
    run(1, second);
    run(2, first);
    run(2, second);
    run(3, second);
    run(3, first);
    EXPECT_EQ(first.disparity.pixels(), alone.disparity.pixels());
    EXPECT_EQ(first.confidence.pixels(), alone.confidence.pixels());
}

TEST(Backends, TheLargestImageDoesNotWrapSizes) {
    // 48 GiB for SGM: either the system lends the addresses, or it says how much was wanted.
    try {
        const auto matcher = backend("cpu").create({8192, 8192, default_options(Method::sgm, {0, 256})});
        EXPECT_GE(matcher->scratch_bytes(), std::size_t{8192} * 8192 * 16);
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::AnyOf(HasSubstr("17180 MB"), HasSubstr("34360 MB")));
    }
}

}  // namespace
}  // namespace disparityd::test
