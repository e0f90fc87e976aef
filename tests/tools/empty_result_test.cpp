// SPDX-License-Identifier: Apache-2.0
//
// The limits were tuned on the seeds from 1 on; those from 1001 on judge them. A few of both are here, the rest is in
// empty_result_of_many_test.cpp.
#include "calibration/empty_result/empty_result.h"

#include <gmock/gmock.h>

#include "tests/tools/named_causes.h"

namespace disparityd::empty_result {
namespace {

using test::made_range;
using test::RenderedPair;
using testing::HasSubstr;

TEST(EmptyResult, NamesTheCauseOfAFewPairs) {
    for (const Kind& kind : kinds) {
        EXPECT_EQ(rightly_named(kind, 1, 2), 2) << kind.words;
        EXPECT_EQ(rightly_named(kind, 1001, 1), 1) << kind.words;
    }
}

TEST(EmptyResult, TellsNothingOfAFewGoodPairs) {
    expect_nothing_told_of_good_pairs(1, 1);
    expect_nothing_told_of_good_pairs(1001, 1);
}

TEST(EmptyResult, SaysWhatReachesTheNearPoints) {
    const RenderedPair pair = test::near_pair(3);
    const LikelyCause found = likely_cause({view(pair.left), view(pair.right), made_range, pair.calibration});
    EXPECT_THAT(found.text, HasSubstr("0 to 31 px that are searched"));
    EXPECT_THAT(found.text, HasSubstr("disparities would reach them"));
}

void expect_a_turn_is_told(unsigned seed, bool of_left) {
    for (const auto& [code, words] : {std::pair(-1, "upside down"), {1, "mirrored"}}) {
        RenderedPair pair = test::good_pair(seed);
        cv::Mat& turned = of_left ? pair.left : pair.right;
        cv::flip(turned, turned, code);
        const LikelyCause found = likely_cause({view(pair.left), view(pair.right), made_range, pair.calibration});
        EXPECT_EQ(found.cause, Cause::turned) << found.text;
        EXPECT_THAT(found.text, HasSubstr(words));
    }
}

TEST(EmptyResult, OneImageThatIsTurnedIsTold) {
    expect_a_turn_is_told(3, false);
}

TEST(EmptyResult, OneImageOfOtherPairsThatIsTurnedIsTold) {
    expect_a_turn_is_told(4, true);
    expect_a_turn_is_told(5, false);
}

TEST(EmptyResult, OfAnUnknownCalibrationTheSizeIsUnknown) {
    calibration::StereoCalibration calibration;
    calibration.width = 640;
    calibration.height = 480;
    calibration.rectified = true;
    EXPECT_FALSE(other_resolution(calibration));
    EXPECT_FALSE(other_resolution(std::nullopt));
    calibration.left = calibration.right = {500, 500, 320, 240, {}};
    EXPECT_FALSE(other_resolution(calibration));
    calibration.width = 320;
    calibration.height = 240;
    ASSERT_TRUE(other_resolution(calibration));
    EXPECT_THAT(other_resolution(calibration)->text, HasSubstr("2.00 times as large as these, 320x240"));
}

TEST(EmptyResult, CountsMeasuredPixelsOfAllFrames) {
    const cv::Mat image(4, 10, CV_8UC1, cv::Scalar(7));
    cv::Mat confidence(4, 10, CV_8UC1, cv::Scalar(0));
    EmptyResult result(made_range);
    EXPECT_EQ(result.measured(), 1);
    EXPECT_EQ(result.note(std::nullopt), "");
    result.add(view(image), view(image), view(confidence));
    confidence.rowRange(0, 2).setTo(200);
    result.add(view(image), view(image), view(confidence));
    EXPECT_EQ(result.measured(), 0.25);
}

TEST(EmptyResult, EyesThatShowTheSamePictureAreTold) {
    const RenderedPair pair = test::good_pair(4);
    const cv::Mat sure(pair.left.size(), CV_8UC1, cv::Scalar(200));
    EmptyResult result(made_range);
    result.add(view(pair.left), view(pair.left), view(sure));
    EXPECT_THAT(result.note(std::nullopt), HasSubstr("both eyes show the same picture"));
    result.add(view(pair.left), view(pair.right), view(sure));
    EXPECT_EQ(result.note(std::nullopt), "") << "not in every frame";
}

}  // namespace
}  // namespace disparityd::empty_result
