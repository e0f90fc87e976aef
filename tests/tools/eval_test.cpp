// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int shift = 6;

/// A Middlebury scene whose left half of the truth is right and whose right half is 8 px off, its outer columns
/// unknown.
void make_scene(const std::string& folder, unsigned seed = 5) {
    std::filesystem::create_directories(folder);
    const Pair pair = shifted_pair(160, 80, shift, seed);
    images::write_png(folder + "/left.png", pair.left);
    images::write_png(folder + "/right.png", pair.right);
    cv::Mat truth(80, 160, CV_8UC1, cv::Scalar(0));
    truth(cv::Rect(32, 8, 48, 64)).setTo(cv::Scalar(shift * 4));
    truth(cv::Rect(80, 8, 48, 64)).setTo(cv::Scalar((shift + 8) * 4));
    images::write_png(folder + "/disp_left.png", truth);
    cv::Mat mask(80, 160, CV_8UC1, cv::Scalar(0));
    mask(cv::Rect(32, 8, 48, 64)).setTo(cv::Scalar(255));
    mask(cv::Rect(80, 8, 48, 64)).setTo(cv::Scalar(128));
    images::write_png(folder + "/mask_nonocc.png", mask);
}

using EvalTest = FolderTest;

TEST_F(EvalTest, ANearlyEmptyResultIsToldOnceWithItsCause) {
    make_scene(path("scene"));
    const Outcome good = run(DISPARITY_EVAL, {"--method", "all", "--scale", "4", path("scene")});
    EXPECT_EQ(good.exit_code, 0) << good.err;
    EXPECT_THAT(good.err, Not(HasSubstr("likely cause")));
    std::filesystem::rename(path("scene/left.png"), path("scene/other.png"));
    std::filesystem::rename(path("scene/right.png"), path("scene/left.png"));
    std::filesystem::rename(path("scene/other.png"), path("scene/right.png"));
    const Outcome exchanged = run(DISPARITY_EVAL, {"--preset", "obstacles", "--backend", "cpu", "--backend",
                                                   "reference", "--scale", "4", path("scene")});
    EXPECT_EQ(exchanged.exit_code, 0) << exchanged.err;
    const auto first = exchanged.err.find("the likely cause: left and right are exchanged");
    ASSERT_NE(first, std::string::npos) << exchanged.err;
    EXPECT_EQ(exchanged.err.find("likely cause", first + 5), std::string::npos) << exchanged.err;
}

TEST_F(EvalTest, FramesOfARenderedSceneHaveTheirExactTruth) {
    const Outcome outcome =
        run(DISPARITY_EVAL, {"--json", "--preset", "obstacles", "scene:vga?width=336&height=188&frames=2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto rows = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0]["scene"], "scene:vga?width=336&height=188&frames=2#0");
    for (const auto& row : rows) {
        EXPECT_LT(row["bad1_nonocc"], 15) << row;
        EXPECT_GT(row["density"], 80) << row;
        EXPECT_LT(row["false_near"], 5) << row;
        EXPECT_GT(row["thin_found"], 20) << row;
    }
    const Outcome wrong = run(DISPARITY_EVAL, {"scene:vga?frames=none"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.err, HasSubstr("frames"));
}

TEST_F(EvalTest, ThinThingsAreCountedByWidthWhereTheyAreKnown) {
    const Outcome outcome = run(DISPARITY_EVAL, {"--thin", "--json", "scene:vga?width=336&height=188&frames=1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto widths = nlohmann::json::parse(outcome.out);
    int found = 0;
    int pixels = 0;
    for (const auto& width : widths) {
        EXPECT_EQ(width["name"], "sgm cpu");
        found += width["found"].get<int>();
        pixels += width["pixels"].get<int>();
    }
    EXPECT_GT(pixels, 500);
    EXPECT_GT(found, pixels / 5);
    make_scene(path("cones"));
    const Outcome unknown = run(DISPARITY_EVAL, {"--thin", "scene:vga", path("cones")});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("cones, which does not say where poles and wires are"));
    EXPECT_EQ(run(DISPARITY_EVAL, {"--thin", "--halves", "3", "scene:vga"}).exit_code, 2);
}

TEST_F(EvalTest, EveryMatcherIsMeasured) {
    make_scene(path("cones"));
    const Outcome outcome = run(DISPARITY_EVAL, {"--method", "all", "--backend", "all", "--opencv", "--json", "-o",
                                                 path("errors"), "--disparities", "16", path("cones")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto rows = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(rows.size(), 3U * 2 + 3);
    for (const auto& row : rows) {
        EXPECT_EQ(row["disparities"], 16);
        EXPECT_GT(row["ms"], 0);
        // Half of the truth is made to be wrong; that half is marked as occluded.
        EXPECT_LT(row["bad1_nonocc"], 15) << row;
        EXPECT_NEAR(row["bad1_all"].get<double>(), 50, 10) << row;
        EXPECT_NEAR(row["bad2_all"].get<double>(), 50, 10) << row;
        EXPECT_GT(row["density"], 85) << row;
    }
    EXPECT_EQ(files_in(path("errors")).size(), rows.size());
    const cv::Mat picture = images::read_image(path("errors/cones_sgm_cpu.png"));
    EXPECT_GE(picture.rows, 80);
    // Beside left image, disparity and errors, a legend with every colour of the errors.
    const cv::Mat legend = picture.colRange(3 * 160, picture.cols);
    for (const cv::Scalar& colour : {cv::Scalar(160, 160, 160), cv::Scalar(40, 40, 230), cv::Scalar(30, 150, 240),
                                     cv::Scalar(200, 110, 30), cv::Scalar(24, 70, 16)}) {
        cv::Mat found;
        cv::inRange(legend, colour, colour, found);
        EXPECT_GT(cv::countNonZero(found), 30) << colour;
    }
}

TEST_F(EvalTest, OptionsThatNoMethodUsesAreRefused) {
    make_scene(path("cones"));
    const Outcome refused = run(DISPARITY_EVAL, {"--method", "sad", "--method", "census", "--p2", "40", path("cones")});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("--p2: only the method sgm uses it, found: sad and census"));
    EXPECT_EQ(run(DISPARITY_EVAL, {"--method", "all", "--p2", "40", path("cones")}).exit_code, 0);
}

/// Rows of a result by the name of their method.
std::map<std::string, nlohmann::json> by_method(const std::string& json) {
    std::map<std::string, nlohmann::json> rows;
    for (const auto& row : nlohmann::json::parse(json)) {
        rows[row["method"]] = row;
    }
    return rows;
}

TEST_F(EvalTest, OnEvenTermsEveryPixelIsJudged) {
    make_scene(path("cones"));
    // Known from the column on that both images see; OpenCV begins at column 16.
    cv::Mat truth(80, 160, CV_8UC1, cv::Scalar(0));
    truth(cv::Rect(shift + 2, 8, 48, 64)).setTo(cv::Scalar(shift * 4));
    images::write_png(path("cones/disp_left.png"), truth);
    images::write_png(path("cones/mask_nonocc.png"), truth * 10);

    const Outcome outcome = run(DISPARITY_EVAL, {"--fair", "--json", "--disparities", "16", path("cones")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    auto rows = by_method(outcome.out);
    ASSERT_EQ(rows.size(), 8U);
    for (const std::string method : {"StereoBM", "StereoSGBM HH", "StereoSGBM 3WAY"}) {
        EXPECT_LT(rows[method]["density"], 90) << method;
        EXPECT_EQ(rows[method + ", fair"]["density"], 100) << method;
        EXPECT_LT(rows[method + ", fair"]["bad1_nonocc"], 5) << method;
    }
    EXPECT_EQ(rows["sgm, fair"]["density"], 100);
    EXPECT_LT(rows["sgm, fair"]["bad1_nonocc"], 5);

    const Outcome table = run(DISPARITY_EVAL, {"--fair", "--method", "all", path("cones")});
    EXPECT_THAT(table.out, HasSubstr("census, fair - best of OpenCV"));
    EXPECT_THAT(table.out, HasSubstr("of 3 results at most the best of OpenCV"));
    EXPECT_EQ(run(DISPARITY_EVAL, {"--fair", "--paper", path("cones")}).exit_code, 2);
}

TEST_F(EvalTest, Fractions) {
    make_scene(path("cones"));
    const Outcome outcome = run(DISPARITY_EVAL, {"--fractions", "--json", "--opencv", path("cones")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    auto rows = by_method(outcome.out);
    ASSERT_EQ(rows.size(), 4U);
    for (const auto& [method, row] : rows) {
        EXPECT_EQ(row["truth_near_whole"], 100) << "the shift is whole";
        EXPECT_EQ(row["fractions"].size(), 16U);
        EXPECT_LT(row["bad05_measured"], 10) << row;
    }
    EXPECT_THAT(run(DISPARITY_EVAL, {"--fractions", path("cones")}).out, HasSubstr("mean"));
}

/// The words of the line of a table that begins with these words; empty where there is none.
std::vector<std::string> line_of(const std::string& text, const std::vector<std::string>& first) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::vector<std::string> found{std::istream_iterator<std::string>(words), {}};
        if (found.size() >= first.size() && std::equal(first.begin(), first.end(), found.begin())) {
            return found;
        }
    }
    return {};
}

TEST_F(EvalTest, ConfidenceIsComparedWithWhatIsRight) {
    make_scene(path("data/cones"));
    make_scene(path("data/teddy"));
    const std::vector<std::string> arguments{"--confidence", "--halves", "3", path("data")};
    const Outcome text = run(DISPARITY_EVAL, arguments);
    ASSERT_EQ(text.exit_code, 0) << text.err;
    for (const std::string part : {"half a: pixels %", "half b: pixels %", "240 to 255", "sparsification area",
                                   "sigma px", "sigma of all, px"}) {
        EXPECT_THAT(text.out, HasSubstr(part));
    }
    const Outcome json = run(DISPARITY_EVAL, {"--confidence", "--json", path("data")});
    ASSERT_EQ(json.exit_code, 0) << json.err;
    const auto all = nlohmann::json::parse(json.out);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0]["weight"].size(), 256U);
    EXPECT_EQ(all[0]["weight"][0], 0);
    EXPECT_GE(all[0]["calibration_error"], 0);
    EXPECT_EQ(all[0]["sigma_px_of_bins"].size(), 16U);
    EXPECT_GT(all[0]["sigma_px"], 0);
    EXPECT_LT(all[0]["sigma_px"], 1);
}

TEST_F(EvalTest, MeansEndTheTable) {
    make_scene(path("data/cones"), 5);
    make_scene(path("data/teddy"), 6);
    const Outcome outcome = run(DISPARITY_EVAL, {"--opencv", "--noise", "9", path("data")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto cones = line_of(outcome.out, {"cones", "sgm", "cpu"});
    const auto teddy = line_of(outcome.out, {"teddy", "sgm", "cpu"});
    const auto mean = line_of(outcome.out, {"mean", "sgm", "cpu"});
    ASSERT_EQ(cones.size(), 14U) << outcome.out;
    ASSERT_EQ(mean.size(), 12U) << "neither disparities nor time";
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(std::stod(mean[3 + i]), (std::stod(cones[4 + i]) + std::stod(teddy[4 + i])) / 2, 0.0101) << i;
    }
    EXPECT_FALSE(line_of(outcome.out, {"mean", "StereoSGBM", "3WAY", "opencv"}).empty());
    EXPECT_THAT(outcome.out, HasSubstr("scenes won: bad-1.0 nonocc at most the best of OpenCV"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("sgm +cpu +[0-2] of 2"));
    EXPECT_THAT(outcome.out, HasSubstr("noise of 9 grey levels"));

    const Outcome plain = run(DISPARITY_EVAL, {path("data")});
    EXPECT_THAT(plain.out, Not(HasSubstr("scenes won"))) << "without OpenCV there is nothing to compare with";
    const Outcome fair = run(DISPARITY_EVAL, {"--fair", path("data")});
    EXPECT_FALSE(line_of(fair.out, {"mean", "of", "backend"}).empty()) << fair.out;
    EXPECT_THAT(fair.out, HasSubstr("D1 nonocc %"));
}

TEST_F(EvalTest, HalvesAreTheSameEachRunAndHaveTheirMeans) {
    for (const char* name : {"cones", "teddy", "art"}) {
        make_scene(path("data/") + name, static_cast<unsigned>(name[0]));
    }
    const std::vector<std::string> arguments{"--halves", "3", "--opencv", "--json", path("data")};
    const Outcome outcome = run(DISPARITY_EVAL, arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto all = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(all["rows"].size(), 3U * 4);
    EXPECT_EQ(all["means"].size(), 4U);
    EXPECT_EQ(all["won"][0]["scenes"], 3);
    EXPECT_EQ(all["halves"]["seed"], 3);
    EXPECT_TRUE(all["noise"].is_null());
    std::vector<std::string> names;
    for (const char* half : {"a", "b"}) {
        const auto& one = all["halves"][half];
        EXPECT_EQ(one["won"][0]["method"], "sgm");
        double sum = 0;
        for (const auto& row : all["rows"]) {
            const bool is_in = std::count(one["scenes"].begin(), one["scenes"].end(), row["scene"]) == 1;
            sum += is_in && row["method"] == "sgm" ? row["d1_all"].get<double>() : 0;
        }
        EXPECT_EQ(one["means"][0]["scenes"], one["scenes"].size());
        EXPECT_NEAR(one["means"][0]["d1_all"].get<double>(), sum / static_cast<double>(one["scenes"].size()), 2e-4);
        names.insert(names.end(), one["scenes"].begin(), one["scenes"].end());
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre("art", "cones", "teddy"));
    EXPECT_EQ(nlohmann::json::parse(run(DISPARITY_EVAL, arguments).out)["halves"], all["halves"]);

    const Outcome text = run(DISPARITY_EVAL, {"--halves", "3", "--fractions", "--markdown", path("data")});
    EXPECT_THAT(text.out, HasSubstr("- A, 2 scenes: "));
    EXPECT_THAT(text.out, HasSubstr("| A / B | sgm | cpu |"));
    EXPECT_THAT(text.out, HasSubstr("| B / A | sgm | cpu |"));
}

TEST_F(EvalTest, NoiseMakesMatchingHarderAndIsTheSameEachRun) {
    make_scene(path("cones"));
    const auto accuracy = [this](const std::string& sigma) {
        const Outcome outcome = run(DISPARITY_EVAL, {"--noise", sigma, "--opencv", "--json", path("cones")});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        auto rows = by_method(outcome.out);
        for (auto& [method, row] : rows) {
            row.erase("ms");
        }
        return rows;
    };
    auto none = accuracy("0"), some = accuracy("40.5");
    EXPECT_EQ(some, accuracy("40.5"));
    for (const char* method : {"sgm", "StereoBM", "StereoSGBM HH"}) {
        EXPECT_GT(some[method]["bad1_nonocc"], none[method]["bad1_nonocc"]) << method;
    }
    auto without = by_method(run(DISPARITY_EVAL, {"--json", path("cones")}).out);
    EXPECT_EQ(without["sgm"]["bad1_all"], none["sgm"]["bad1_all"]) << "no noise is as if it were not given";
}

TEST_F(EvalTest, TheNoiseLevelIsThatOfTheNoiseWhereItIsToAdapt) {
    make_scene(path("cones"));
    const auto rows = [this](std::vector<std::string> options) {
        options.insert(options.end(), {"--preset", "obstacles", "--json", path("cones")});
        const Outcome outcome = run(DISPARITY_EVAL, options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return by_method(outcome.out)["sgm"];
    };
    EXPECT_EQ(rows({"--adaptive-noise"})["noise_level"], 0);
    EXPECT_EQ(rows({"--adaptive-noise", "--noise", "8"})["noise_level"], 3);
    EXPECT_EQ(rows({"--adaptive-noise", "--noise", "8", "--shared-noise"})["noise_level"], 3);
    EXPECT_EQ(rows({"--noise", "8"})["noise_level"], 3) << "the preset has it on";
    EXPECT_FALSE(rows({"--no-adaptive-noise", "--noise", "8"}).contains("noise_level"));
    const Outcome table = run(DISPARITY_EVAL, {"--preset", "obstacles", "--adaptive-noise", path("cones")});
    EXPECT_THAT(table.out, HasSubstr("noise level"));
}

TEST_F(EvalTest, WrongSeedsAndSigmasAreRefusedInOneLine) {
    make_scene(path("cones"));
    const auto refused = [this](const std::string& option, const std::string& value, const std::string& says) {
        const Outcome outcome = run(DISPARITY_EVAL, {option + "=" + value, path("cones")});
        EXPECT_EQ(outcome.exit_code, 2) << option << ' ' << value;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr(option), HasSubstr(says)));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    };
    for (const char* seed : {"-1", "2147483648", "1.5", "first"}) {
        refused("--halves", seed, std::string("found '") + seed + "', allowed: a whole number from 0 to 2147483647");
    }
    for (const char* sigma : {"-0.5", "64.01", "nan", "inf", "much", "3,5"}) {
        refused("--noise", sigma, std::string("found '") + sigma + "', allowed: a number from 0 to 64");
    }
    refused("--halves", "1", "found 1 scene in DATA, allowed: at least 2");
}

TEST_F(EvalTest, ConditionsAreNamedAndHaveCoursesOfTheirOwn) {
    const auto refused = [](const std::vector<std::string>& arguments, const std::string& says) {
        const Outcome outcome = run(DISPARITY_EVAL, arguments);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr(says));
    };
    refused({"--scan", "--condition", "rain", "courses:1"},
            "--condition: found 'courses:1' as DATA, allowed: conditions:SEED, such as conditions:1");
    refused({"--scan", "--condition", "snow", "conditions:1"}, "--condition: found 'snow', allowed: noise, ");
    refused({"--scan", "conditions:x"}, "found 'conditions:x', allowed: conditions:SEED alone, SEED 0 .. 1000000");
}

TEST_F(EvalTest, DisparitiesCoverTheTruthByDefault) {
    make_scene(path("data/cones"));
    write_text(path("data/cones/calib.txt"), "doffs=0\nndisp=40\n");
    const Outcome outcome = run(DISPARITY_EVAL, {"--json", path("data")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)[0]["disparities"], 48);
    EXPECT_THAT(run(DISPARITY_EVAL, {path("data")}).out, HasSubstr("bad-1.0 nonocc %"));
}

TEST_F(EvalTest, BadDataIsRefused) {
    std::filesystem::create_directory(path("empty"));
    for (const std::string& data : {path("empty"), path("missing")}) {
        const Outcome outcome = run(DISPARITY_EVAL, {data});
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr(data));
    }
    make_scene(path("cones"));
    EXPECT_EQ(run(DISPARITY_EVAL, {"--paper", path("cones")}).exit_code, 2) << "three scenes are missing";
    images::write_png(path("cones/right.png"), cv::Mat(80, 150, CV_8UC1, cv::Scalar(3)));
    const Outcome unequal = run(DISPARITY_EVAL, {path("cones")});
    EXPECT_EQ(unequal.exit_code, 2);
    EXPECT_THAT(unequal.err, HasSubstr("150"));
}

/// What the defaults reach on the evaluation data.
class DefaultsTest : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(data_ + "/middlebury2003")) {
            GTEST_SKIP() << "no evaluation data: set DISPARITYD_DATA";
        }
    }

    const char* given_ = std::getenv("DISPARITYD_DATA");
    const std::string data_ = given_ != nullptr ? given_ : DISPARITYD_DATA_DEFAULT;
};

TEST_F(DefaultsTest, EveryCellOfThePaperIsReached) {
    const Outcome outcome = run(DISPARITY_EVAL, {"--paper", data_});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("12 of 12 cells"));
}

TEST_F(DefaultsTest, ConesWithEveryPixelJudged) {
    const Outcome outcome =
        run(DISPARITY_EVAL, {"--interpolate", "--disparities", "64", "--json", data_ + "/middlebury2003/cones"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_LE(nlohmann::json::parse(outcome.out)[0]["bad1_nonocc"], 4.1);
}

TEST_F(DefaultsTest, AtMostTheBestOfOpencv) {
    const Outcome outcome = run(DISPARITY_EVAL, {"--fair", data_ + "/middlebury2003"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("2 of 2 results"));
}

}  // namespace
}  // namespace disparityd::test
