// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/emulation/thoroughness.h"
#include "tests/emulation/with_settings.h"
#include "tests/kernels/support.h"

// kernels/cuda on the emulated device, in the table of back ends as "cuda".
namespace disparityd::test {
namespace {

using simt::Order;

using Bytes = Image<std::uint8_t>;

// All equal, two values, extremes, noise, a shifted copy.
struct Pair {
    Pair(Random& random, int width, int height) : left(width, height), right(width, height) {
        const int kind = pick(random, 0, 4);
        left = kind == 0 ? Bytes(width, height, 99) : noise(random, width, height, 0, kind == 1 ? 1 : 255);
        right = kind == 0   ? left
                : kind == 2 ? shifted(random, left, pick(random, -20, 20))
                            : noise(random, width, height);
        for (Bytes* image : {&left, &right}) {
            for (std::uint8_t& pixel : image->pixels()) {
                pixel = kind != 3 ? pixel : pixel < 128 ? 0 : 255;
            }
        }
    }
    Pair(Bytes left_image, Bytes right_image) : left(std::move(left_image)), right(std::move(right_image)) {}
    Bytes left, right;
};

MatchOptions any_options(Random& random) {
    MatchOptions options;
    options.method = static_cast<Method>(pick(random, 0, 2));
    options.range = {pick(random, -40, 40), 16 * pick(random, 1, 5)};
    options.sgm.paths = pick(random, 0, 2) == 0 ? 4 : 8;
    options.sgm.p2 = pick(random, 2, 193);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    options.post.left_right_check = pick(random, 0, 3) > 0;
    options.post.median = std::array{0, 3, 5}[static_cast<std::size_t>(pick(random, 0, 2))];
    options.post.speckle_size = pick(random, 0, 1) * pick(random, 0, 40);
    options.post.speckle_step = pick(random, 0, 2);
    options.post.interpolate = pick(random, 0, 1) == 1;
    return options;
}

struct Result {
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    std::vector<std::uint16_t> depth;
    bool operator==(const Result&) const = default;
};

Result result_of(std::string_view name, const Pair& pair, const MatchOptions& options) {
    Serial serial;
    const auto matcher = backend(name).create({pair.left.width(), pair.left.height(), options});
    Frame frame(*matcher, pair.left, pair.right);
    match(*matcher, frame.view, serial);
    return {frame.disparity.pixels(), frame.confidence.pixels(), frame.depth.pixels()};
}

void expect_equal_to_reference(const Pair& pair, const MatchOptions& options) {
    ASSERT_EQ(problem(options), "");
    const Result expected = result_of("reference", pair, options);
    const Result found = result_of("cuda", pair, options);
    const auto where = [&] {
        return std::to_string(pair.left.width()) + "x" + std::to_string(pair.left.height()) + " " +
               std::string(name(options.method)) + ", D " + std::to_string(options.range.count) + " from " +
               std::to_string(options.range.first) + ", " + std::to_string(options.sgm.paths) + " paths";
    };
    ASSERT_EQ(found.disparity, expected.disparity) << where();
    ASSERT_EQ(found.confidence, expected.confidence) << where();
    ASSERT_EQ(found.depth, expected.depth) << where();
}

// Threads and blocks in every order, memory that nobody has written with one value and another.
simt::Settings nth_settings(int n) {
    constexpr std::array<unsigned char, 2> poisons = {0xa5, 0x00};
    return {static_cast<Order>(n % 3), static_cast<unsigned>(n), poisons[static_cast<std::size_t>(n / 3 % 2)],
            n % 4 == 0};
}

TEST(EmulatedCuda, EqualsTheReferenceForAnyOptions) {
    Random random(50);
    for (int round = 0; round < (all_rounds ? 36 : 9); ++round) {
        const WithSettings settings(nth_settings(round));
        const Pair pair(random, pick(random, 1, 70), pick(random, 1, 25));
        expect_equal_to_reference(pair, any_options(random));
    }
}

TEST(EmulatedCuda, EqualsTheReferenceForEveryNumberOfDisparities) {
    Random random(51);
    for (int disparities = 16; disparities <= 256; disparities += all_rounds ? 16 : 112) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            const WithSettings settings(nth_settings(disparities / 16));
            MatchOptions options = any_options(random);
            options.method = method;
            options.range = {pick(random, 0, 1) == 0 ? 0 : -disparities / 2, disparities};
            expect_equal_to_reference(Pair(random, 83, 4), options);
        }
    }
}

TEST(EmulatedCuda, EqualsTheReferenceOnHostileSizes) {
    Random random(52);
    int n = 0;
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {4, 3}, {15, 9}, {31, 2}, {32, 3}, {33, 3}, {3, 33}, {64, 2}}) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            for (const DisparityRange range : {DisparityRange{0, 16}, {0, 256}, {-256, 256}, {256, 16}, {-256, 16}}) {
                if (++n % 4 != 0 && !all_rounds) {
                    continue;
                }
                const WithSettings settings(nth_settings(n));
                MatchOptions options = any_options(random);
                options.method = method;
                options.range = range;
                expect_equal_to_reference(Pair(random, width, height), options);
            }
        }
    }
}

TEST(EmulatedCuda, TheLargestPenaltiesAndCostsDoNotOverflow) {
    Random random(53);
    Pair pair(random, 90, 5);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 90; ++x) {
            // Census words that differ in as many bits as can be: rising on the left, falling on the right.
            pair.left.at(x, y) = static_cast<std::uint8_t>(x + y);
            pair.right.at(x, y) = static_cast<std::uint8_t>(255 - x - y);
        }
    }
    for (const int p1 : {1, 192}) {
        for (const int disparities : {80, 256}) {
            MatchOptions options;
            options.sgm.p1 = p1;
            options.sgm.p2 = 193;
            options.range = {0, disparities};
            expect_equal_to_reference(pair, options);
        }
    }
    // Every absolute difference of SAD at its largest.
    expect_equal_to_reference(Pair(Bytes(40, 9, 0), Bytes(40, 9, 255)), default_options(Method::sad, {-4, 16}));
}

// One frame, all orders and two poisons: no barrier is missing and nothing unwritten is read, as far as this data
// shows.
TEST(EmulatedCuda, OrderAndUnwrittenMemoryDoNotMatter) {
    Random random(54);
    const Pair pair(random, 35, 34);
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        MatchOptions options = default_options(method, {-3, 32});
        options.post.speckle_size = 12;
        options.post.interpolate = true;
        const Result expected = result_of("reference", pair, options);
        for (int n = 0; n < 6; ++n) {
            const WithSettings settings(nth_settings(n));
            ASSERT_EQ(result_of("cuda", pair, options), expected) << name(method) << ", settings " << n;
        }
    }
}

TEST(EmulatedCuda, AnIntegratedDeviceGivesTheSameWithMappedMemory) {
    Random random(55);
    simt::Machine jetson;
    jetson.integrated = true;
    for (int round = 0; round < 3; ++round) {
        const WithMachine machine(jetson);
        MatchOptions options = any_options(random);
        options.method = static_cast<Method>(round);
        expect_equal_to_reference(Pair(random, 35, 11), options);
    }
}

TEST(EmulatedCuda, NothingIsLeftFromTheFrameBefore) {
    Random random(56);
    Serial serial;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        MatchOptions options = default_options(method, {0, 16});
        options.post.speckle_size = 20;
        options.post.interpolate = true;
        const Pair one(random, 33, 21);
        const Pair other(random, 33, 21);
        const auto matcher = backend("cuda").create({33, 21, options});
        for (const Pair* pair : {&one, &other, &one}) {
            Frame frame(*matcher, pair->left, pair->right);
            match(*matcher, frame.view, serial);
            ASSERT_EQ((Result{frame.disparity.pixels(), frame.confidence.pixels(), frame.depth.pixels()}),
                      result_of("reference", *pair, options));
        }
    }
}

// As in a pipeline: each stage has a thread, and the next frame is rectified while this one is matched.
TEST(EmulatedCuda, StagesWorkOnTwoFramesAtTheSameTime) {
    constexpr int width = 24;
    constexpr int height = 9;
    Random random(59);
    const auto raw = noise(random, 2 * width, height);
    const Rectifier rectifier;
    MatchOptions options = default_options(Method::sgm, {0, 16});
    const auto matcher = backend("cuda").create({width, height, options});
    std::vector<std::unique_ptr<Frame>> frames;
    for (int i = 0; i < 4; ++i) {
        frames.push_back(std::make_unique<Frame>(*matcher, Bytes(width, height), Bytes(width, height)));
        frames.back()->view.raw = {raw.plane().data, PixelFormat::grey8, width, height, 2 * width};
        frames.back()->view.rectifier = &rectifier;
    }
    const auto run = [&](int stage, const FrameView& view) {
        Serial serial;
        std::array<std::chrono::nanoseconds, 8> times{};
        const std::size_t steps = matcher->stages()[static_cast<std::size_t>(stage)].steps.size();
        matcher->run(stage, view, serial, std::span(times).first(steps));
    };
    run(0, frames[0]->view);
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
        std::thread rectifies([&] { run(0, frames[i + 1]->view); });
        run(1, frames[i]->view);
        rectifies.join();
        EXPECT_EQ(frames[i]->disparity.pixels(), frames[0]->disparity.pixels());
    }
    const Pair pair(frames[0]->left, frames[0]->right);
    EXPECT_EQ(frames[0]->disparity.pixels(), result_of("reference", pair, options).disparity);
}

TEST(EmulatedCuda, DepthMayBeMissing) {
    Random random(57);
    Serial serial;
    const Pair pair(random, 30, 12);
    const auto matcher = backend("cuda").create({30, 12, default_options(Method::sgm, {0, 16})});
    Frame frame(*matcher, pair.left, pair.right);
    frame.view.depth = {};
    match(*matcher, frame.view, serial);
    EXPECT_EQ(frame.depth.pixels(), std::vector<std::uint16_t>(360, 4321));
}

TEST(EmulatedCuda, EveryStepIsTimed) {
    Random random(58);
    Serial serial;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        const Pair pair(random, 30, 12);
        const auto matcher = backend("cuda").create({30, 12, default_options(method, {0, 16})});
        ASSERT_EQ(matcher->stages().front().name, "rectify");
        Frame frame(*matcher, pair.left, pair.right);
        std::vector<std::chrono::nanoseconds> times(matcher->stages()[1].steps.size(), std::chrono::nanoseconds(-1));
        matcher->run(1, frame.view, serial, times);
        for (const auto time : times) {
            EXPECT_GE(time.count(), 0);
        }
    }
}

}  // namespace
}  // namespace disparityd::test
