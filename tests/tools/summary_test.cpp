// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/summary.h"

#include <cmath>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tools/eval/report.h"

namespace disparityd::eval {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Three scenes of two matchers with one figure.
Measurements three_scenes() {
    return {{{"bad %", "bad"}},
            {{"a", "sgm", "cpu", {1}},
             {"a", "BM", "opencv", {10}},
             {"b", "sgm", "cpu", {2}},
             {"b", "BM", "opencv", {unknown}},
             {"c", "sgm", "cpu", {6}},
             {"c", "BM", "opencv", {20}}}};
}

TEST(MeansTest, OfEachMatcherOverTheScenesWhereAFigureIsKnown) {
    const std::vector<Mean> all = means(three_scenes());
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].method, "sgm");
    EXPECT_EQ(all[0].scenes, 3U);
    EXPECT_DOUBLE_EQ(all[0].values[0], 3);
    EXPECT_EQ(all[1].backend, "opencv");
    EXPECT_DOUBLE_EQ(all[1].values[0], 15);
}

TEST(MeansTest, OfSomeScenes) {
    const std::vector<Mean> some = means(three_scenes(), [](const std::string& scene) { return scene == "b"; });
    EXPECT_EQ(some[0].scenes, 1U);
    EXPECT_DOUBLE_EQ(some[0].values[0], 2);
    EXPECT_TRUE(std::isnan(some[1].values[0]));
    EXPECT_EQ(figure_text(some[1].values[0], 2), "-");
    EXPECT_TRUE(means_json(some, three_scenes().figures)[1]["bad"].is_null());
}

TEST(MeansTest, EveryFigureOfTheTableEndsIt) {
    std::ostringstream text;
    print_table({{"cones", "sgm", "cpu", 64, {1, 2, 3, 4, 5, 6, 7, 0.5, 80}, 8},
                 {"teddy", "sgm", "cpu", 64, {2, 4, 6, 8, 10, 12, 14, 1.5, 90}, 9}},
                false, text);
    EXPECT_THAT(text.str(), ContainsRegex("D1 nonocc %  D1 all %  density %  false near %  thin %"));
    EXPECT_THAT(text.str(), ContainsRegex("teddy .* 2.00 +4.00 +6.00 +8.00 +12.00 +14.00 +10.00 +1.50 +90.00 +9.0\n"));
    EXPECT_THAT(text.str(),
                ContainsRegex("\nmean +sgm +cpu +1.50 +3.00 +4.50 +6.00 +9.00 +10.50 +7.50 +1.00 +85.00\n$"));
}

/// A result whose bad-1.0 is known.
Row row(const std::string& scene, const std::string& method, const std::string& backend, double bad) {
    return {scene, method, backend, 64, {bad, 0, 0, 0, 100}, 1};
}

std::vector<Row> fair_rows() {
    return {row("a", fair_name("sgm"), "cpu", 4),   row("a", fair_name("BM"), "opencv", 5),
            row("a", fair_name("HH"), "opencv", 4), row("b", "sgm", "cpu", 0),
            row("b", fair_name("sgm"), "cpu", 3),   row("b", fair_name("BM"), "opencv", 2.75),
            row("b", fair_name("HH"), "opencv", 8), row("c", fair_name("sgm"), "cpu", unknown),
            row("c", fair_name("BM"), "opencv", 1)};
}

TEST(WinsTest, AtMostTheBestOfOpencvWins) {
    const std::vector<Wins> all = wins(fair_rows());
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].method, "sgm");
    EXPECT_EQ(all[0].backend, "cpu");
    ASSERT_EQ(all[0].scenes.size(), 2U) << "of c, no pixel is known to be seen by both cameras";
    EXPECT_TRUE(all[0].scenes[0].won()) << "as good is won";
    EXPECT_FALSE(all[0].scenes[1].won());
    EXPECT_DOUBLE_EQ(all[0].scenes[1].opencv, 2.75);
}

TEST(WinsTest, WithoutOpencvNothingIsCompared) {
    EXPECT_TRUE(wins({row("a", fair_name("sgm"), "cpu", 4)}).empty());
}

Summary summary_of_three() {
    return {three_scenes(), wins(fair_rows()), Halves{5, {"a", "c"}, {"b"}}, 2.5};
}

TEST(SummaryTest, TextHasTheWinsBothHalvesEachWayAndTheNoise) {
    std::ostringstream text;
    print_summary(summary_of_three(), false, text);
    EXPECT_THAT(text.str(),
                ContainsRegex("sgm +cpu +1 of 2 +1 of 1 +0 of 1 +3.50 +3.38\n- lost, sgm cpu: b \\+0.25\n"));
    EXPECT_THAT(text.str(), HasSubstr("halves of seed 5"));
    EXPECT_THAT(text.str(), HasSubstr("- A, 2 scenes: a, c\n- B, 1 scene: b\n"));
    EXPECT_THAT(text.str(), ContainsRegex("A / B +sgm +cpu +3.50 / 2.00\n"));
    EXPECT_THAT(text.str(), ContainsRegex("A / B +BM +opencv +15.00 / -\n"));
    EXPECT_THAT(text.str(), ContainsRegex("B / A +sgm +cpu +2.00 / 3.50\n"));
    EXPECT_THAT(text.str(), HasSubstr("noise of 2.5 grey levels"));
}

TEST(SummaryTest, WhatWasNotAskedForIsNotPrinted) {
    std::ostringstream text;
    print_summary({three_scenes(), {}, {}, {}}, false, text);
    EXPECT_EQ(text.str(), "");
    print_summary({three_scenes(), std::vector<Wins>(), {}, {}}, false, text);
    EXPECT_THAT(text.str(), testing::AllOf(HasSubstr("none is compared"), Not(HasSubstr("halves"))));
}

TEST(SummaryTest, JsonHasTheAgreedKeys) {
    EXPECT_EQ(nlohmann::json(summary_json(summary_of_three())), nlohmann::json::parse(R"({
        "means": [{"method": "sgm", "backend": "cpu", "scenes": 3, "bad": 3.0},
                  {"method": "BM", "backend": "opencv", "scenes": 3, "bad": 15.0}],
        "won": [{"method": "sgm", "backend": "cpu", "scenes": 2, "won": 1, "bad1_nonocc": 3.5,
                 "opencv_bad1_nonocc": 3.375, "lost": ["b"]}],
        "halves": {"seed": 5,
                   "a": {"scenes": ["a", "c"],
                         "means": [{"method": "sgm", "backend": "cpu", "scenes": 2, "bad": 3.5},
                                   {"method": "BM", "backend": "opencv", "scenes": 2, "bad": 15.0}],
                         "won": [{"method": "sgm", "backend": "cpu", "scenes": 1, "won": 1, "bad1_nonocc": 4.0,
                                  "opencv_bad1_nonocc": 4.0, "lost": []}]},
                   "b": {"scenes": ["b"],
                         "means": [{"method": "sgm", "backend": "cpu", "scenes": 1, "bad": 2.0},
                                   {"method": "BM", "backend": "opencv", "scenes": 1, "bad": null}],
                         "won": [{"method": "sgm", "backend": "cpu", "scenes": 1, "won": 0, "bad1_nonocc": 3.0,
                                  "opencv_bad1_nonocc": 2.75, "lost": ["b"]}]}},
        "noise": 2.5})"));
    const auto little = summary_json({three_scenes(), {}, {}, {}});
    EXPECT_TRUE(little["won"].is_null() && little["halves"].is_null() && little["noise"].is_null());
}

}  // namespace
}  // namespace disparityd::eval
