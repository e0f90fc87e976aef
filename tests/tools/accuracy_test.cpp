// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/accuracy.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/eval/fair_table.h"
#include "tools/eval/means.h"
#include "tools/eval/paper.h"
#include "tools/eval/report.h"
#include "tools/eval/scene.h"
#include "tools/eval/subpixel.h"
#include "tools/eval/wins.h"

namespace disparityd::eval {
namespace {

constexpr float none = std::numeric_limits<float>::infinity();

TEST(AccuracyTest, HandMadeMap) {
    // Errors:                0      1      1.25   2      2.25   rejected  no truth  exact, occluded  3, occluded
    const images::FloatMap truth{9, 1, {10, 10, 10, 10, 10, 10, none, 20, 20}};
    const images::FloatMap found{9, 1, {10, 11, 8.75F, 12, 12.25F, none, 5, 20, 23}};
    const Accuracy accuracy = measure(found, truth, {1, 1, 1, 1, 1, 1, 1, 0, 0});
    EXPECT_DOUBLE_EQ(accuracy.bad1_nonocc, 100.0 * 4 / 6) << "1.25, 2, 2.25 and the rejected one; exactly 1 is good";
    EXPECT_DOUBLE_EQ(accuracy.bad2_nonocc, 100.0 * 2 / 6);
    EXPECT_DOUBLE_EQ(accuracy.bad1_all, 100.0 * 5 / 8);
    EXPECT_DOUBLE_EQ(accuracy.bad2_all, 100.0 * 3 / 8);
    EXPECT_DOUBLE_EQ(accuracy.density, 100.0 * 7 / 8);
}

TEST(AccuracyTest, D1IsMoreThan3PxAndMoreThan5Percent) {
    struct Case {
        float truth, found;
        bool bad;
    };
    for (const Case& one :
         {Case{10, 13, false}, Case{10, 13.0625F, true}, Case{10, 6.9375F, true},
          Case{60, 63, false},    // 5 % and 3 px exactly
          Case{100, 104, false},  // 4 % only
          Case{100, 105, false}, Case{100, 105.0625F, true}, Case{100, 95, false}, Case{100, 94.9375F, true},
          Case{80, 84, false}, Case{80, 84.0625F, true}, Case{58, 61, false},  // more than 5 %, 3 px exactly
          Case{0, 3, false}, Case{0, 3.0625F, true}, Case{-100, -104, false}, Case{-100, -105.0625F, true},
          Case{100, none, true}, Case{100, 100, false}}) {
        const Accuracy accuracy = measure({1, 1, {one.found}}, {1, 1, {one.truth}}, {1});
        EXPECT_EQ(accuracy.d1_nonocc, one.bad ? 100 : 0) << one.found << " for " << one.truth;
        EXPECT_EQ(accuracy.d1_all, accuracy.d1_nonocc);
    }
}

TEST(AccuracyTest, D1OfAllPixelsAndOfThoseNotOccluded) {
    // Errors:                3.5   4 (of 80)  rejected  0    no truth  4, occluded  5.5 (5.5 %), occluded
    const images::FloatMap truth{7, 1, {10, 80, 10, 10, none, 10, 100}};
    const images::FloatMap found{7, 1, {13.5F, 84, none, 10, 5, 14, 105.5F}};
    const Accuracy accuracy = measure(found, truth, {1, 1, 1, 1, 1, 0, 0});
    EXPECT_DOUBLE_EQ(accuracy.d1_nonocc, 100.0 * 2 / 4);
    EXPECT_DOUBLE_EQ(accuracy.d1_all, 100.0 * 4 / 6);
    EXPECT_TRUE(std::isnan(measure(found, truth, {}).d1_nonocc));
}

TEST(AccuracyTest, FalseNearIsWhatReadsNearerOfWhatIsRead) {
    // Nearer:                3.5   4 (of 80)  rejected  0    no truth  4   farther: 5
    const images::FloatMap truth{7, 1, {10, 80, 10, 10, none, 10, 10}};
    const images::FloatMap found{7, 1, {13.5F, 84, none, 10, 50, 14, 5}};
    EXPECT_DOUBLE_EQ(measure(found, truth, {}).false_near, 100.0 * 2 / 5);
    EXPECT_TRUE(std::isnan(measure({1, 1, {none}}, {1, 1, {3}}, {}).false_near)) << "nothing is read";
}

TEST(AccuracyTest, ThinIsWhatIsFoundOfPolesAndWires) {
    const images::FloatMap truth{5, 1, {10, 10, 10, 10, none}};
    const images::FloatMap found{5, 1, {11, 11.0625F, none, 10, 10}};
    EXPECT_DOUBLE_EQ(measure(found, truth, {}, {1, 1, 1, 0, 1}).thin_found, 100.0 / 3);
    EXPECT_TRUE(std::isnan(measure(found, truth, {}).thin_found)) << "not known";
    EXPECT_THROW(measure(found, truth, {}, {1}), std::invalid_argument);
}

TEST(AccuracyTest, FractionsCountAsTheyAre) {
    const images::FloatMap truth{2, 1, {10.25F, 10.25F}};
    const Accuracy accuracy = measure({2, 1, {11.25F, 11.3125F}}, truth, {1, 1});
    EXPECT_DOUBLE_EQ(accuracy.bad1_nonocc, 50);
}

TEST(AccuracyTest, WithoutAMaskNonOccludedIsUnknown) {
    const Accuracy accuracy = measure({1, 1, {3}}, {1, 1, {3}}, {});
    EXPECT_TRUE(std::isnan(accuracy.bad1_nonocc));
    EXPECT_DOUBLE_EQ(accuracy.bad1_all, 0);
}

TEST(AccuracyTest, NothingToJudge) {
    const Accuracy accuracy = measure({1, 1, {3}}, {1, 1, {none}}, {1});
    EXPECT_TRUE(std::isnan(accuracy.bad1_all));
    EXPECT_TRUE(std::isnan(accuracy.density));
}

TEST(AccuracyTest, SizesMustAgree) {
    EXPECT_THROW(measure({2, 1, {3, 3}}, {1, 2, {3, 3}}, {}), std::invalid_argument);
    EXPECT_THROW(measure({2, 1, {3, 3}}, {2, 1, {3, 3}}, {1}), std::invalid_argument);
}

TEST(SubpixelTest, HandMadeMap) {
    // Errors:                0.25     0.5      0.5625   2      rejected  no truth  0, occluded
    const images::FloatMap truth{7, 1, {10.25F, 10.5F, 10, 12, 10, none, 20}};
    const images::FloatMap found{7, 1, {10, 11, 9.4375F, 10, none, 5, 20}};
    const SubpixelAccuracy accuracy = measure_subpixel(found, truth, {1, 1, 1, 1, 1, 1, 0});
    EXPECT_DOUBLE_EQ(accuracy.bad05, 100.0 * 3 / 5) << "0.5625, 2 and the rejected one; exactly 0.5 is good";
    EXPECT_DOUBLE_EQ(accuracy.bad05_measured, 100.0 * 2 / 4);
    EXPECT_DOUBLE_EQ(accuracy.rms, std::sqrt((0.25 * 0.25 + 0.5 * 0.5 + 0.5625 * 0.5625) / 3));
    EXPECT_DOUBLE_EQ(accuracy.near_whole, 75);
    EXPECT_DOUBLE_EQ(accuracy.truth_near_whole, 50);
    EXPECT_DOUBLE_EQ(accuracy.fractions[0], 75);
    EXPECT_DOUBLE_EQ(accuracy.fractions[7], 25);
}

TEST(SubpixelTest, NearWholeIsASixteenthOnEitherSide) {
    const images::FloatMap found{6, 1, {-0.0625F, 0.0625F, 3, 0.125F, -0.125F, 2.875F}};
    const SubpixelAccuracy accuracy = measure_subpixel(found, {6, 1, {0, 0, 0, 0, 0, 0}}, {});
    EXPECT_DOUBLE_EQ(accuracy.near_whole, 50);
    EXPECT_DOUBLE_EQ(accuracy.fractions[15], 100.0 / 6) << "below 0 as above";
}

TEST(SubpixelTest, NothingToJudgeAndSizes) {
    EXPECT_TRUE(std::isnan(measure_subpixel({1, 1, {3}}, {1, 1, {none}}, {}).bad05));
    EXPECT_TRUE(std::isnan(measure_subpixel({1, 1, {none}}, {1, 1, {3}}, {}).near_whole));
    EXPECT_DOUBLE_EQ(measure_subpixel({1, 1, {none}}, {1, 1, {3}}, {}).bad05, 100);
    EXPECT_THROW(measure_subpixel({2, 1, {3, 3}}, {1, 2, {3, 3}}, {}), std::invalid_argument);
    EXPECT_THROW(measure_subpixel({1, 1, {3}}, {1, 1, {3}}, {1, 1}), std::invalid_argument);
}

TEST(SubpixelTest, TheMeanOfEachMethodEndsTheTable) {
    SubpixelAccuracy good, bad;
    good.bad05 = 2;
    bad.bad05 = 5;
    std::ostringstream text;
    print_subpixel_table({{"cones", "sgm", "cpu", 64, good}, {"teddy", "sgm", "cpu", 64, bad}}, false, text);
    EXPECT_THAT(text.str(), testing::ContainsRegex("mean +sgm +cpu +3.50"));
}

TEST(FairTableTest, OursAreComparedWithTheBestOfOpencv) {
    const auto row = [](const char* scene, const std::string& method, const char* backend, double bad) {
        return Row{scene, method, backend, 64, {bad, 0, 0, 0, 100}, 1};
    };
    std::ostringstream text;
    print_fair_table(
        {row("cones", "sgm", "cpu", 9), row("cones", fair_name("sgm"), "cpu", 4), row("cones", "StereoBM", "opencv", 1),
         row("cones", fair_name("StereoBM"), "opencv", 7), row("cones", fair_name("StereoSGBM HH"), "opencv", 4.5),
         row("teddy", "sgm", "cpu", 3), row("teddy", fair_name("sgm"), "cpu", 2.75),
         row("teddy", "StereoBM", "opencv", 8), row("teddy", fair_name("StereoBM"), "opencv", 8),
         row("teddy", fair_name("StereoSGBM HH"), "opencv", 2.5)},
        false, text);
    EXPECT_THAT(text.str(), testing::ContainsRegex("cones \\(64\\) .* -0.50"));
    EXPECT_THAT(text.str(), testing::ContainsRegex("teddy \\(64\\) .* \\+0.25"));
    EXPECT_THAT(text.str(), testing::ContainsRegex("mean +6.00 +4.50 +3.38 +7.50 +3.50 +-0.12"));
    EXPECT_THAT(text.str(), testing::HasSubstr("1 of 2 results at most the best of OpenCV"));
}

TEST(CoveringDisparitiesTest, NextMultipleOf16ThatReachesTheTruth) {
    EXPECT_EQ(covering_disparities({1, 1, {none}}, 0), 16);
    EXPECT_EQ(covering_disparities({1, 1, {15}}, 0), 16);
    EXPECT_EQ(covering_disparities({1, 1, {15.01F}}, 0), 32) << "15.01 lies between candidates 15 and 16";
    EXPECT_EQ(covering_disparities({1, 1, {3}}, 70), 80);
    EXPECT_EQ(covering_disparities({1, 1, {900}}, 0), 256);
}

TEST(MedianTest, MiddleOfTheTimes) {
    EXPECT_DOUBLE_EQ(median({5, 1, 9}), 5);
    EXPECT_DOUBLE_EQ(median({4, 1, 9, 2}), 3);
}

TEST(ReportTest, JsonIsAListWithTheAgreedKeys) {
    std::ostringstream text;
    print_json(rows_json({{"cones", "sgm", "cpu", 128, {4.5, 12.25, 3, 10, 99.5, 2.75, 8.125, 0.5, 80}, 17.25},
                          {"other", "StereoBM", "opencv", 64, measure({1, 1, {3}}, {1, 1, {3}}, {}), 1}}),
               text);
    const auto list = nlohmann::json::parse(text.str());
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0],
              nlohmann::json::parse(R"({"scene": "cones", "method": "sgm", "backend": "cpu", "disparities": 128,
        "bad1_nonocc": 4.5, "bad1_all": 12.25, "bad2_nonocc": 3.0, "bad2_all": 10.0, "d1_nonocc": 2.75,
        "d1_all": 8.125, "density": 99.5, "false_near": 0.5, "thin_found": 80.0, "ms": 17.25})"));
    EXPECT_TRUE(list[1]["bad1_nonocc"].is_null());
    EXPECT_EQ(list[1]["bad1_all"], 0);
}

TEST(PaperTest, CellsAreCountedAgainstThePaper) {
    std::ostringstream text;
    print_paper_table(
        {{"cones", "sgm", "cpu", 128, {6.9, 0, 0, 0, 100}, 1}, {"teddy", "sad", "cpu", 128, {16.7, 0, 0, 0, 100}, 1}},
        false, text);
    EXPECT_THAT(text.str(), testing::HasSubstr("1 of 2 cells at most the paper's figure"));
    EXPECT_THAT(text.str(), testing::HasSubstr("+0.10"));
    EXPECT_THAT(text.str(), testing::ContainsRegex("mean +sgm +cpu +6.9 +6.90 +\\+0.00 +100.0\n"));
    EXPECT_EQ(paper_scene("middlebury2001/tsukuba")->disparities, 32);
    EXPECT_EQ(paper_scene("art"), nullptr);
}

}  // namespace
}  // namespace disparityd::eval
