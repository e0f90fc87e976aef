// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.h"
#include "tools/eval/benchmark/benchmark_rows.h"
#include "tools/eval/benchmark/holes.h"
#include "tools/eval/benchmark/region_tally.h"
#include "tools/eval/benchmark/regions.h"
#include "tools/eval/benchmark/result_files.h"
#include "tools/eval/benchmark/sparsification.h"
#include "tools/images/disparity_file.h"
#include "tools/images/fill_holes.h"

namespace disparityd::eval {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float hole = std::numeric_limits<float>::infinity();

TEST(FillFromBackground, TheSmallerOfBothSidesThenWholeRows) {
    const images::FloatMap map{4, 5, {hole, hole, hole, hole,  //
                                      hole, 5,    hole, 3,     //
                                      hole, hole, hole, hole,  //
                                      7,    hole, hole, 9,     //
                                      hole, hole, hole, hole}};
    EXPECT_THAT(images::fill_from_background(map).values, ElementsAre(5, 5, 3, 3,              //
                                                                      5, 5, 3, 3,              //
                                                                      hole, hole, hole, hole,  //
                                                                      7, 7, 7, 9,              //
                                                                      7, 7, 7, 9));
    EXPECT_THAT(images::fill_from_background({2, 1, {hole, hole}}).values, ElementsAre(hole, hole));
    EXPECT_THAT(images::fill_all(map).values, ElementsAre(5, 5, 3, 3,  //
                                                          5, 5, 3, 3,  //
                                                          5, 5, 3, 3,  //
                                                          7, 7, 7, 9,  //
                                                          7, 7, 7, 9))
        << "every pixel";
    EXPECT_THAT(images::fill_all({1, 2, {hole, hole}}).values, ElementsAre(hole, hole));
}

TEST(RegionTallies, HolesAreBadOrLeftOutAndErrorsAreOfTheOthers) {
    const images::FloatMap truth{6, 1, {10, 10, 10, 10, 100, hole}};
    const JudgedMap map{{6, 1, {10, 10.5F, 13.5F, hole, 104, 3}}, {}};
    const std::vector<std::uint8_t> all{1, 1, 1, 1, 1, 0};
    const RegionTally bad = tally(map, map.disparity, truth, all, Holes::bad);
    EXPECT_EQ(bad.pixels, 5U);
    EXPECT_EQ(bad.judged, 5U);
    EXPECT_THAT(bad.bad, ElementsAre(3, 3, 3, 3, 1)) << "exactly 0.5 and 4 are good; the hole is bad";
    EXPECT_EQ(bad.d1, 2U) << "4 of 100 are less than 5 %";
    EXPECT_THAT(bad.quantiles, ElementsAre(0.5, 4, 4, 4));
    EXPECT_DOUBLE_EQ(bad.sum, 8);
    const RegionTally left_out = tally(map, map.disparity, truth, all, Holes::left_out);
    EXPECT_EQ(left_out.judged, 4U);
    EXPECT_THAT(left_out.bad, ElementsAre(2, 2, 2, 2, 0));
    const RegionTally filled = tally(map, images::fill_from_background(map.disparity), truth, all, Holes::filled);
    EXPECT_THAT(filled.bad, ElementsAre(3, 3, 3, 3, 0)) << "the hole is filled with 13.5";
    EXPECT_EQ(filled.measured, 4U);
    EXPECT_EQ(filled.with_error, 5U);
}

TEST(Sparsifications, PixelsOfOneConfidenceGoTogether) {
    const Sparsification best = sparsification({0, 1, 2, 3}, {4, 3, 2, 1});
    EXPECT_DOUBLE_EQ(best.area_px(), 0);
    EXPECT_DOUBLE_EQ(best.error_px[0], 1.5);
    EXPECT_DOUBLE_EQ(best.error_px[50], 0.5);
    const Sparsification equal = sparsification({0, 1, 2, 3}, {5, 5, 5, 5});
    EXPECT_DOUBLE_EQ(equal.error_px[0], equal.error_px[90]) << "removing any of them changes nothing";
    EXPECT_GT(equal.relative_area(), 0);
    EXPECT_DOUBLE_EQ(sparsification({0, 0}, {1, 2}).relative_area(), 0);
}

TEST(Regions, EdgesAndWeakTextureAreWithoutOccludedPixels) {
    Scene scene{"", cv::Mat(1, 12, CV_8UC1, cv::Scalar(50)), {}, {12, 1, {}}, {}, {}, 0};
    scene.truth.values = {5, 5, 5, 5, 5, 5, 5, 7, 7, hole, 7, 7};
    scene.non_occluded = {1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    scene.left.at<std::uint8_t>(0, 11) = 90;
    const std::vector<RegionMask> regions = regions_of(scene);
    ASSERT_EQ(regions.size(), 4U);
    EXPECT_THAT(regions[2].pixels, ElementsAre(0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 1, 1)) << "4 px from the step of 2 px";
    EXPECT_THAT(regions[3].pixels, ElementsAre(1, 1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0));
}

TEST(MiddleburyWeights, OfTheTrainingSet) {
    EXPECT_EQ(middlebury_weight("trainingQ/Vintage"), 0.5);
    EXPECT_EQ(middlebury_weight("adirondack"), 1);
    EXPECT_EQ(middlebury_weight("cones"), std::nullopt);
}

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const std::invalid_argument& problem) {
        return problem.what();
    }
    return "nothing was refused";
}

TEST(ResultFilesOf, AFolderOrAPattern) {
    const test::TemporaryFolder folder;
    const std::string root = folder.path();
    const auto write = [&](const std::string& name) {
        std::filesystem::create_directories(std::filesystem::path(root + "/" + name).parent_path());
        images::write_disparity_pfm(root + "/" + name, images::FloatMap{1, 1, {3}});
    };
    const ResultFiles files = parse_result_files("--results", "mine=" + root);
    EXPECT_EQ(files.matcher, "mine");
    EXPECT_EQ(parse_result_files("--results", root + "/").matcher, std::filesystem::path(root).filename());
    EXPECT_THAT(refusal([&] { parse_result_files("--results", root + "/absent"); }), HasSubstr("is no folder"));
    EXPECT_THAT(refusal([&] { parse_result_files("--results", "=" + root); }), HasSubstr("allowed: NAME=WHERE"));
    for (const auto& [file, scene] : {std::pair("training/1.pfm", "training/1"),
                                      {"2.pfm", "training/2"},
                                      {"disp_0/3.pfm", "training/3"},
                                      {"low_res_two_view/delivery.pfm", "delivery"},
                                      {"alley_1_f.pfm", "alley_1/f"},
                                      {"Piano/disp0ABC.pfm", "Piano"},
                                      {"Pipes/disp0.pfm", "training/Pipes"}}) {
        write(file);
        EXPECT_EQ(find_result(files, scene), root + "/" + file);
    }
    EXPECT_THAT(refusal([&] { find_result(files, "absent"); }), HasSubstr("absent: mine has no file in"));
    const ResultFiles pattern{"p", root + "/{folder}/left/{frame}.pfm"};
    write("A/left/0006.pfm");
    write("left/lone.pfm");
    EXPECT_EQ(find_result(pattern, "A/0006"), root + "/A/left/0006.pfm");
    EXPECT_EQ(find_result(pattern, "lone"), root + "/left/lone.pfm");
    EXPECT_THAT(refusal([&] { read_result(root + "/2.pfm", 2, 1); }), HasSubstr("found 1x1 px, allowed: 2x1"));
    EXPECT_THAT(refusal([&] { read_result(root + "/2.tif", 1, 1); }), HasSubstr(".pfm"));
    EXPECT_THAT(read_confidence(root + "/2.pfm", 1, 1), ElementsAre(3));
}

}  // namespace
}  // namespace disparityd::eval
