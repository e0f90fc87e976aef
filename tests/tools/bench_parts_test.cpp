// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/kernels/support.h"
#include "tools/bench/alternation.h"
#include "tools/bench/naive.h"
#include "tools/bench/report.h"
#include "tools/bench/step_work.h"

namespace disparityd::bench {

namespace {

using test::Image;
using test::noise;
using test::Random;

TEST(NaiveTest, BothBuildsGiveTheSameBytes) {
    Random random(4);
    auto image = noise(random, 50, 20);
    Image<std::uint64_t> expected(50, 20);
    reference::census(image.plane(), expected.plane(), image.rows());
    for (const Build build : {Build::as_compiled, Build::not_vectorised}) {
        Image<std::uint64_t> words(50, 20);
        naive_steps(build).matching.of(CensusCost::census_9x7).census(image.plane(), words.plane(), image.rows());
        EXPECT_EQ(words.pixels(), expected.pixels());
    }
}

TEST(NaiveTest, TheTwoBuildsAreDifferentCode) {
    EXPECT_NE(naive_steps(Build::as_compiled).matching.of(CensusCost::census_9x7).census,
              naive_steps(Build::not_vectorised).matching.of(CensusCost::census_9x7).census);
    EXPECT_NE(naive_steps(Build::as_compiled).matching.aggregate,
              naive_steps(Build::not_vectorised).matching.aggregate);
}

/// Counts its runs, measured or not.
class CountingContestant final : public Contestant {
public:
    CountingContestant(std::vector<int>& order, int number) : order_(order), number_(number) {}
    void prepare() override {}
    void run() override { order_.push_back(number_); }

private:
    std::vector<int>& order_;
    int number_;
};

Contestants contestants(std::vector<int>& order, int count) {
    Contestants all;
    for (int i = 0; i < count; ++i) {
        all.push_back(std::make_unique<CountingContestant>(order, i));
    }
    return all;
}

StereoPair small_pair() {
    return {"made", cv::Mat(4, 6, CV_8UC1), cv::Mat(4, 6, CV_8UC1), 16};
}

std::vector<int> turns(std::vector<int> runs) {
    runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    return runs;
}

TEST(AlternationTest, EverybodyRunsOncePerRound) {
    std::vector<int> order;
    const auto found = alternate(small_pair(), contestants(order, 3), {.rounds = 4, .seconds = 3600, .min_rounds = 3});
    EXPECT_EQ(turns(order), (std::vector<int>{0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}));
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].ms.size(), 4U);
    EXPECT_EQ(found[0].width, 6);
    EXPECT_EQ(found[0].scene, "made");
}

TEST(AlternationTest, WhoIsSlowSitsOutRounds) {
    std::vector<int> order;
    // With no time at all everybody is too slow: the least number of rounds, spread over all.
    const auto found = alternate(small_pair(), contestants(order, 2), {.rounds = 30, .seconds = 0, .min_rounds = 3});
    EXPECT_EQ(turns(order), (std::vector<int>{0, 1, 0, 1, 0, 1}));
    EXPECT_EQ(found[1].ms.size(), 3U);
}

TEST(AlternationTest, AFrameIsMeasuredAfterAnotherUnlessItIsLong) {
    // Before the first one nobody knows how long it takes.
    for (const auto& [long_frame_ms, runs] : {std::pair{3.6e6, 6U}, std::pair{0.0, 4U}}) {
        std::vector<int> order;
        const Patience patience{.rounds = 3, .seconds = 3600, .min_rounds = 3, .long_frame_ms = long_frame_ms};
        const auto found = alternate(small_pair(), contestants(order, 1), patience);
        EXPECT_EQ(found[0].ms.size(), 3U);
        EXPECT_EQ(order.size(), runs) << long_frame_ms << " ms";
    }
}

Measurement measured(std::string name, std::string isa, int threads, std::vector<double> ms) {
    Measurement one;
    one.scene = "made";
    one.width = 1000;
    one.height = 500;
    one.disparities = 64;
    one.name = std::move(name);
    one.isa = std::move(isa);
    one.threads = threads;
    one.memory_mb = std::nan("");
    one.cpu_ms = ms;
    one.ms = std::move(ms);
    return one;
}

TEST(MeasurementTest, MedianAndQuartiles) {
    const Measurement one = measured("cpu/sgm", "AVX2", 1, {9, 1, 5, 3, 7});
    EXPECT_DOUBLE_EQ(one.median_ms(), 5);
    EXPECT_DOUBLE_EQ(one.min_ms(), 1);
    EXPECT_DOUBLE_EQ(one.lower_quartile_ms(), 3);
    EXPECT_DOUBLE_EQ(one.upper_quartile_ms(), 7);
    EXPECT_DOUBLE_EQ(one.frames_per_second(), 200);
    EXPECT_DOUBLE_EQ(one.gde_per_second(), 1000 * 500 * 64 / 5e6);
}

TEST(ReportTest, RatiosAreAgainstTheSameMethodAndAsManyThreads) {
    std::ostringstream text;
    print_measurements({measured("cpu/sgm", "AVX2", 2, {2}), measured("opencv/3way", "SSE2", 1, {14}),
                        measured("opencv/3way", "SSE2", 2, {7}), measured("naive/sgm", "compiled", 1, {50}),
                        measured("naive/sgm", "scalar", 1, {222}), measured("naive/sad", "scalar", 1, {1000})},
                       true, text);
    EXPECT_THAT(text.str(), testing::HasSubstr("| 25.0 | 111.0 | 3.50 |"));
    EXPECT_THAT(text.str(), testing::HasSubstr("made 1000x500, D 64"));
}

TEST(ReportTest, UnknownMemoryIsNull) {
    std::ostringstream text;
    print_json({measured("cpu/sgm", "AVX2", 2, {2})}, text);
    EXPECT_TRUE(nlohmann::json::parse(text.str())[0]["memory_mb"].is_null());
}

TEST(StepWorkTest, VolumesAreWrittenAndReadOnce) {
    MatchOptions options;
    options.range.count = 128;
    constexpr double pixels = 450 * 375;
    const auto work = step_work("dsi+aggregate+wta", options, pixels);
    ASSERT_TRUE(work);
    // A byte of cost and a byte of sums per candidate, each written and read; a little for the images.
    EXPECT_NEAR(work->bytes, 4 * pixels * 128, 0.05 * 4 * pixels * 128);
    options.sgm.p2 = 100;
    EXPECT_NEAR(step_work("dsi+aggregate+wta", options, pixels)->bytes, 6 * pixels * 128, 0.05 * 6 * pixels * 128);
    options.sgm.paths = 4;
    EXPECT_NEAR(step_work("dsi+aggregate+wta", options, pixels)->bytes, 6 * pixels * 128, 0.05 * 6 * pixels * 128);
    options.sgm.p2 = 63;
    EXPECT_NEAR(step_work("dsi+aggregate+wta", options, pixels)->bytes, 4 * pixels * 128, 0.05 * 4 * pixels * 128);
    EXPECT_FALSE(step_work("make coffee", options, pixels));
}

TEST(StepWorkTest, EveryStepOfOursIsCounted) {
    for (const Method method : {Method::sad, Method::census, Method::sgm}) {
        const MatchOptions options = default_options(method, {0, 16});
        for (const Backend& row : backends()) {
            if (!row.available()) {
                continue;
            }
            const auto matcher = row.create({32, 16, options});
            for (const StageInfo& stage : matcher->stages().subspan(1)) {
                for (const std::string_view step : stage.steps) {
                    EXPECT_TRUE(step_work(std::string(step), options, 1)) << step;
                }
            }
        }
    }
}

}  // namespace
}  // namespace disparityd::bench
