// SPDX-License-Identifier: Apache-2.0
// Step 17 of docs/algorithm.md.
#include "pipeline/temporal_stage.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

constexpr std::int64_t frame_ns = 33'333'333;

/// Does the tasks from the last to the first, as many at a time as it says.
class Backwards final : public Parallel {
public:
    explicit Backwards(int workers) : workers_(workers) {}
    int workers() const override { return workers_; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        for (int i = count; i-- > 0;) {
            task(i);
        }
    }

private:
    int workers_;
};

/// One pixel through time.
class OnePixel {
public:
    /// Returns the disparity that the stage makes of one in 1/16 px.
    int add(int disparity, int confidence = 200) { return add_after(frame_ns, disparity, confidence); }

    int add_after(std::int64_t gap_ns, int disparity, int confidence = 200, bool discontinuity = false) {
        auto d16 = static_cast<std::int16_t>(disparity);
        auto sureness = static_cast<std::uint8_t>(confidence);
        FrameView view;
        view.disparity = {&d16, 1, 1, 1};
        view.confidence = {&sureness, 1, 1, 1};
        now_ns_ += gap_ns;
        Serial serial;
        stage_.run({.view = view, .memory = {}, .monotonic_ns = now_ns_, .discontinuity = discontinuity, .up = {}},
                   serial);
        EXPECT_EQ(sureness, confidence);
        return d16;
    }

private:
    TemporalStage stage_{1, 1};
    std::int64_t now_ns_ = 1'000'000'000;
};

TEST(TemporalStage, WhatAgreesBecomesAMean) {
    OnePixel pixel;
    EXPECT_EQ(pixel.add(160), 160);
    EXPECT_EQ(pixel.add(162), 161);  // 648 + floor((5 * -8 + 4) / 8) = 643, by 4: 160.75
    EXPECT_EQ(pixel.add(162), 161);  // 648 + floor((5 * -5 + 4) / 8) = 645
    EXPECT_EQ(pixel.add(162), 162);  // 648 + floor((5 * -3 + 4) / 8) = 646
    EXPECT_EQ(pixel.add(158), 160);  // 632 + floor((5 * 14 + 4) / 8) = 641
}

TEST(TemporalStage, AMeanIsAtMostAQuarterOfAPixelAway) {
    OnePixel pixel;
    pixel.add(160);
    EXPECT_EQ(pixel.add(176), 172);
    EXPECT_EQ(pixel.add(160), 164);
}

TEST(TemporalStage, WhatDiffersByMoreThanAPixelIsTakenAtOnce) {
    OnePixel pixel;
    pixel.add(160);
    EXPECT_EQ(pixel.add(177), 177);
    EXPECT_EQ(pixel.add(1000), 1000);
    EXPECT_EQ(pixel.add(-4000), -4000);
    EXPECT_EQ(pixel.add(8184), 8184);
}

TEST(TemporalStage, WhatIsNotMeasuredStaysAsItIsAndBeginsAnew) {
    OnePixel pixel;
    pixel.add(160);
    EXPECT_EQ(pixel.add(164, 0), 164);  // as interpolation leaves it
    EXPECT_EQ(pixel.add(168), 168);
    EXPECT_EQ(pixel.add(-4112, 0), -4112);
    EXPECT_EQ(pixel.add(-4096), -4096);  // the least disparity agrees with nothing
    pixel.add(0, 0);
    EXPECT_EQ(pixel.add(8184), 8184);
}

TEST(TemporalStage, MeansAreDroppedWhereFramesDoNotFollowEachOther) {
    OnePixel pixel;
    pixel.add(160);
    EXPECT_EQ(pixel.add_after(frame_ns, 168, 200, true), 168);
    EXPECT_EQ(pixel.add_after(300'000'000, 160), 164);
    EXPECT_EQ(pixel.add_after(300'000'001, 168), 168);
    EXPECT_EQ(pixel.add_after(-frame_ns, 160), 160);
    EXPECT_EQ(pixel.add_after(0, 168), 168);
}

TEST(TemporalStage, ASteadyApproachIsLessThanTwoFramesBehind) {
    for (const int step : {1, 2, 3, 8, 16, 17}) {
        OnePixel pixel;
        int now = 160;
        for (int i = 0; i < 40; ++i, now += step) {
            EXPECT_LE(now - pixel.add(now), std::min(step > 16 ? 0 : 2 * step, 4)) << step;
        }
    }
}

TEST(TemporalStage, NoiseOfAStillWallIsHalved) {
    OnePixel pixel;
    std::mt19937 random(5);
    double raw = 0;
    double mean = 0;
    for (int i = 0; i < 10000; ++i) {
        const int noise = static_cast<int>(random() % 13) - 6;
        const int left = pixel.add(160 + noise) - 160;
        raw += noise * noise;
        mean += left * left;
    }
    EXPECT_LT(mean, raw * 0.3);
}

/// The disparities of some frames, with any number of workers.
std::vector<std::int16_t> filtered(Parallel& workers) {
    constexpr int width = 37;
    constexpr int height = 23;
    constexpr std::size_t size = std::size_t{width} * height;
    std::mt19937 random(7);
    TemporalStage stage(width, height);
    std::vector<std::int16_t> all;
    for (int i = 0; i < 8; ++i) {
        std::vector<std::int16_t> disparity(size);
        std::vector<std::uint8_t> confidence(size);
        std::generate(disparity.begin(), disparity.end(),
                      [&] { return static_cast<std::int16_t>(160 + random() % 24); });
        std::generate(confidence.begin(), confidence.end(), [&] { return static_cast<std::uint8_t>(random() % 4); });
        FrameView view;
        view.disparity = {disparity.data(), width, height, width};
        view.confidence = {confidence.data(), width, height, width};
        stage.run({.view = view, .memory = {}, .monotonic_ns = i * frame_ns, .up = {}}, workers);
        all.insert(all.end(), disparity.begin(), disparity.end());
    }
    return all;
}

TEST(TemporalStage, TheNumberOfWorkersChangesNothing) {
    Serial serial;
    const std::vector<std::int16_t> expected = filtered(serial);
    for (const int workers : {2, 3, 7, 64}) {
        Backwards many(workers);
        EXPECT_EQ(filtered(many), expected) << workers;
    }
}

}  // namespace
}  // namespace disparityd::pipeline
