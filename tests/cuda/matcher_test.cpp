// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <thread>

#include "tests/cuda/compare.h"
#include "tests/cuda/device_under_test.h"

// The back end cuda against the reference: on the emulated device, and on a real one where there is one.
namespace disparityd::test {
namespace {

TEST_F(CudaDevice, EqualsTheReferenceForAnyOptions) {
    Random random(50);
    for (int round = 0; round < 36 / one_round_of; ++round) {
        const Variation variation(round);
        const Pair pair(random, pick(random, 1, 70), pick(random, 1, 25));
        expect_equal_to_reference(pair, any_options(random));
    }
}

TEST_F(CudaDevice, EqualsTheReferenceForEveryNumberOfDisparities) {
    Random random(51);
    for (int disparities = 16; disparities <= 256; disparities += all_rounds ? 16 : 240) {
        for (const auto& [method, cost] : methods_and_costs) {
            const Variation variation(disparities / 16);
            MatchOptions options = any_options(random);
            options.method = method;
            options.cost = cost;
            options.range = {pick(random, 0, 1) == 0 ? 0 : -disparities / 2, disparities};
            expect_equal_to_reference(Pair(random, 83, 4), options);
        }
    }
}

TEST_F(CudaDevice, EqualsTheReferenceOnHostileSizes) {
    Random random(52);
    int n = 0;
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {4, 3}, {15, 9}, {31, 2}, {32, 3}, {33, 3}, {3, 33}, {64, 2}}) {
        for (const auto& [method, cost] : methods_and_costs) {
            for (const DisparityRange range : {DisparityRange{0, 16}, {0, 256}, {-256, 256}, {256, 16}, {-256, 16}}) {
                if (++n % one_round_of != 0) {
                    continue;
                }
                const Variation variation(n);
                MatchOptions options = any_options(random);
                options.method = method;
                options.cost = cost;
                options.range = range;
                expect_equal_to_reference(Pair(random, width, height), options);
            }
        }
    }
}

// Frame by frame in one matcher, whose operations are put together anew when the level changes; in images of one row
// and more, across the tiles of the census.
TEST_F(CudaDevice, NoiseLevelsEqualTheReference) {
    Random random(58);
    int n = 0;
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 9}, {35, 1}, {40, 4}, {33, 35}, {70, 12}}) {
        if (++n % one_round_of != 0) {
            continue;
        }
        const Variation variation(n);
        MatchOptions options = options_with_noise_levels(random);
        options.adaptive_noise = true;
        const auto matcher = backend("cuda").create({width, height, options});
        options.adaptive_noise = false;
        Serial serial;
        for (const int level : {2, 0, 1, 1, 3}) {
            const Pair pair(random, width, height);
            options.noise_level = level;
            expect_result(result_of(*matcher, pair, serial, level), result_of("reference", pair, options),
                          matcher->config(), serial);
        }
        expect_equal_to_reference(Pair(random, width, height), options);
    }
}

// The rows above and below a pixel count too: in images of one row, two and more, across the tiles of the census, with
// all that SGM can be asked for.
TEST_F(CudaDevice, CensusAndGradientEqualsTheReferenceWithAllThatSgmHas) {
    Random random(53);
    int n = 0;
    for (const int height : {1, 3, 33}) {
        for (const int disparities : {16, 80, 256}) {
            for (const int paths : {4, 8}) {
                for (const bool adaptive : {false, true}) {
                    if (++n % one_round_of != 0) {
                        continue;
                    }
                    const Variation variation(n);
                    MatchOptions options = any_options(random);
                    options.method = Method::sgm;
                    options.cost = CensusCost::census_7x5_gradient;
                    options.range = {pick(random, 0, 1) * -disparities / 2, disparities};
                    options.sgm = {.paths = paths,
                                   .p1 = pick(random, 1, 20),
                                   .p2 = pick(random, 0, 1) == 0 ? 60 : 193,
                                   .adaptive_p2 = adaptive,
                                   .p2_slope = pick(random, 1, 8),
                                   .p2_min = pick(random, 0, 60)};
                    const int width = height > 3 ? 35 : disparities + 20;  // some pixels have all candidates inside
                    expect_equal_to_reference(Pair(random, width, height), options);
                }
            }
        }
    }
}

TEST_F(CudaDevice, TheLargestPenaltiesAndCostsDoNotOverflow) {
    const Pair pair = pair_of_opposites(90, 5);
    for (const CensusCost cost : {CensusCost::census_9x7, CensusCost::census_7x5_gradient}) {
        for (const int p1 : {1, 192}) {
            for (const int disparities : {80, 256}) {
                MatchOptions options;
                options.cost = cost;
                options.sgm.p1 = p1;
                options.sgm.p2 = 193;
                options.range = {0, disparities};
                expect_equal_to_reference(pair, options);
            }
        }
    }
    // Every absolute difference of SAD at its largest.
    expect_equal_to_reference(Pair(Bytes(40, 9, 0), Bytes(40, 9, 255)), default_options(Method::sad, {-4, 16}));
}

TEST_F(CudaDevice, NothingIsLeftFromTheFrameBefore) {
    Random random(56);
    Serial serial;
    for (const auto& [method, cost] : methods_and_costs) {
        MatchOptions options = default_options(method, {0, 16});
        options.cost = cost;
        options.post.speckle_size = 20;
        options.post.interpolate = true;
        const Pair one(random, 33, 21);
        const Pair other(random, 33, 21);
        const auto matcher = backend("cuda").create({33, 21, options});
        for (const Pair* pair : {&one, &other, &one}) {
            ASSERT_EQ(result_of(*matcher, *pair, serial), result_of("reference", *pair, options));
        }
    }
}

TEST_F(CudaDevice, TheNearGuardEqualsTheReferences) {
    Random random(62);
    Pair pair(noise(random, 170, 40), Bytes(170, 40));
    pair.right = shifted(random, pair.left, 40);
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        MatchOptions options = default_options(method, {-3, 16});
        options.post.near_guard = true;
        options.post.interpolate = method == Method::census;
        expect_equal_to_reference(pair, options);
    }
}

// As in a pipeline: each stage has a thread, and the next frame is rectified while this one is matched.
TEST_F(CudaDevice, StagesWorkOnTwoFramesAtTheSameTime) {
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
        std::vector<std::chrono::nanoseconds> times(matcher->stages()[static_cast<std::size_t>(stage)].steps.size());
        matcher->run(stage, view, serial, times);
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

// The calibration may be corrected, and depth asked for, between two frames.
TEST_F(CudaDevice, DepthFollowsTheScaleOfEachFrame) {
    Random random(61);
    Serial serial;
    const Pair pair(random, 30, 12);
    const MatcherConfig config{30, 12, default_options(Method::census, {0, 16})};
    const auto cuda = backend("cuda").create(config);
    const auto reference = backend("reference").create(config);
    for (const DepthScale scale : {DepthScale{1600000, 3}, {1600000, 3}, {800000, 3}, {800000, -2}, {}, {1600000, 3}}) {
        for (const bool depth : {true, false}) {
            Frame found(*cuda, pair.left, pair.right);
            Frame expected(*reference, pair.left, pair.right);
            for (Frame* frame : {&found, &expected}) {
                frame->view.depth_scale = scale;
                frame->view.depth = depth ? frame->view.depth : Plane<std::uint16_t>{};
                frame->view.depth_error =
                    depth == (scale.k > 1000000) ? frame->view.depth_error : Plane<std::uint16_t>{};
                frame->view.subpixel_error = 64 + scale.offset16;
            }
            match_pair(*cuda, found.view, serial);
            match_pair(*reference, expected.view, serial);
            ASSERT_EQ(found.depth.pixels(), expected.depth.pixels()) << scale.k << ' ' << scale.offset16;
            ASSERT_EQ(found.depth_error.pixels(), expected.depth_error.pixels()) << scale.k << ' ' << scale.offset16;
            ASSERT_EQ(found.disparity.pixels(), expected.disparity.pixels());
        }
    }
}

TEST_F(CudaDevice, DepthMayBeMissing) {
    Random random(57);
    Serial serial;
    const Pair pair(random, 30, 12);
    const auto matcher = backend("cuda").create({30, 12, default_options(Method::sgm, {0, 16})});
    Frame frame(*matcher, pair.left, pair.right);
    frame.view.depth = {};
    frame.view.depth_error = {};
    match_pair(*matcher, frame.view, serial);
    EXPECT_EQ(frame.depth.pixels(), std::vector<std::uint16_t>(360, 4321));
    EXPECT_EQ(frame.depth_error.pixels(), std::vector<std::uint16_t>(360, 5432));
}

TEST_F(CudaDevice, EveryStepIsTimed) {
    Random random(58);
    Serial serial;
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        const Pair pair(random, 30, 12);
        const auto matcher = backend("cuda").create({30, 12, default_options(method, {0, 16})});
        ASSERT_EQ(matcher->stages().front().kind, StageKind::rectify);
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
