// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/calibration/board/drawn_board.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

constexpr int width = 640;
constexpr int height = 360;
const calibration::Board board{9, 6, 30};

class CalibrateTest : public FolderTest {
protected:
    /// Views of a drawn board as left0.png, right0.png, ...; every view twice, as a person holds still.
    void make_views(std::size_t count, const calibration::Board& shown = board) {
        const calibration::test::BoardPainter painter(capture::scene_calibration(width, height), shown);
        const auto poses = calibration::test::careful_poses(shown);
        std::vector<std::uint8_t> picture;
        for (std::size_t i = 0; i < 2 * count; ++i) {
            if (i % 2 == 0) {
                picture = painter.draw(poses.at(i / 2));
            }
            const cv::Mat both(height, 2 * width, CV_8U, picture.data());
            const std::string number = std::to_string(i) + ".png";
            ASSERT_TRUE(cv::imwrite(path("left" + number), both(cv::Rect(0, 0, width, height))));
            ASSERT_TRUE(cv::imwrite(path("right" + number), both(cv::Rect(width, 0, width, height))));
        }
    }

    Outcome calibrate(std::vector<std::string> options) {
        std::vector<std::string> arguments{"calibrate", path("left%d.png") + "," + path("right%d.png"), "-o",
                                           path("out.yml")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run(DISPARITYCTL, arguments);
    }
};

TEST_F(CalibrateTest, WhatCannotBeWrittenIsRefusedBeforeViewsAreTaken) {
    // No views are there: they are not even looked for.
    const Outcome outcome = calibrate({"--square", "30", "--report", path("nowhere/report.png")});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("report.png: the folder " + path("nowhere") + " is not there"));
}

TEST_F(CalibrateTest, WritesACalibrationThatIsRead) {
    make_views(13);
    const Outcome outcome = calibrate({"--square", "30", "--json", "--report", path("report.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto result = nlohmann::json::parse(outcome.out);
    EXPECT_LT(result["rms_px"], 0.2);
    EXPECT_GE(result["views"].size(), 11U);
    EXPECT_LE(result["views"].size(), 13U) << "a board that is held still is one view";
    EXPECT_THAT(outcome.err, HasSubstr("view 1 of 20, covered left "));
    EXPECT_THAT(outcome.err, HasSubstr("has not moved"));

    const auto read = calibration::read_calibration(path("out.yml"), width, height);
    const auto truth = capture::scene_calibration(width, height);
    EXPECT_NEAR(read.left.fx / truth.left.fx, 1, 0.01);
    EXPECT_NEAR(read.translation[0], truth.translation[0], 1);
    EXPECT_EQ(result["views"][0]["frame"], "left0.png, right0.png");
    for (const char* eye : {"left", "right"}) {
        EXPECT_EQ(result[eye]["parts"], 9);
        EXPECT_EQ(result[eye]["parts_seen"], 9);
        EXPECT_GT(result[eye]["covered_ratio"], 0.4);
    }
    EXPECT_EQ(result["verdict"], "good") << result["reasons"];
    EXPECT_TRUE(result["left_out"].empty());
    const cv::Mat report = cv::imread(path("report.png"));
    EXPECT_EQ(report.cols, 4 * 320);
    EXPECT_GT(report.rows, 6 * 180);

    // Nothing is overwritten, and the same views give the same file.
    EXPECT_EQ(calibrate({"--square", "30"}).exit_code, 2);
    const std::string first = read_file(path("out.yml"));
    const Outcome again = calibrate({"--square", "30", "--force"});
    ASSERT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.out, HasSubstr("left0.png, right0.png"));
    EXPECT_THAT(again.out, HasSubstr("verdict: good\n"));
    EXPECT_EQ(read_file(path("out.yml")), first);
}

TEST_F(CalibrateTest, AlsoWritesOtherModesAndLeavesBadViewsOut) {
    make_views(13);
    // One eye sees the board of another instant.
    std::filesystem::copy(path("right12.png"), path("right14.png"), std::filesystem::copy_options::overwrite_existing);
    std::filesystem::copy(path("right12.png"), path("right15.png"), std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(calibrate({"--square", "30", "--also", "wide"}).err, HasSubstr("--also: found 'wide'"));
    EXPECT_THAT(calibrate({"--square", "30", "--also", "640x480"}).err, HasSubstr("calibrate it by itself"));
    const Outcome outcome =
        calibrate({"--square", "30", "--json", "--also", "320x180", "--report", path("report.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto result = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(result["left_out"].size(), 1U) << outcome.out;
    EXPECT_EQ(result["left_out"][0]["frame"], "left14.png, right14.png");
    EXPECT_LT(result["rms_px"], 0.2);
    const auto whole = calibration::read_calibration(path("out.yml"), width, height);
    const auto half = calibration::read_calibration(path("out-320x180.yml"), 320, 180);
    EXPECT_DOUBLE_EQ(half.left.fx, whole.left.fx / 2);
    EXPECT_DOUBLE_EQ(half.right.cy, whole.right.cy / 2 - 0.25);
    EXPECT_EQ(half.left.distortion, whole.left.distortion);
    EXPECT_EQ(half.translation, whole.translation);
}

TEST_F(CalibrateTest, NamesTheBoardThatIsShown) {
    make_views(4, {8, 6, 30});
    const Outcome part = calibrate({"--square", "30", "--columns", "7"});
    EXPECT_THAT(part.err, HasSubstr("the board has 8 x 6 inner corners, not 7 x 6: --columns 8 --rows 6"));
    const Outcome wrong = calibrate({"--square", "30", "--columns", "12"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.err, HasSubstr("not seen whole"));
    EXPECT_THAT(wrong.err, HasSubstr("the board has 8 x 6 inner corners, not 12 x 6: --columns 8 --rows 6"));
}

TEST_F(CalibrateTest, SwappedEyesAreRefusedAndLeaveNothing) {
    make_views(13);
    write_text(path("out.yml"), "the calibration before");
    const Outcome outcome = run(DISPARITYCTL, {"calibrate", path("right%d.png") + "," + path("left%d.png"), "--square",
                                               "30", "-o", path("out.yml"), "--report", path("report.png"), "--force"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("exchange the two eyes of the source"));
    EXPECT_EQ(read_file(path("out.yml")), "the calibration before");
    EXPECT_FALSE(std::filesystem::exists(path("report.png")));
}

TEST_F(CalibrateTest, NamesOfOtherFormatsAreRefused) {
    const Outcome report = calibrate({"--square", "30", "--report", path("report.bmp")});
    EXPECT_EQ(report.exit_code, 2);
    EXPECT_THAT(report.err, HasSubstr("allowed: .png, .jpg, .jpeg"));
    const Outcome output = run(DISPARITYCTL, {"calibrate", path("x%d.png"), "--square", "30", "-o", path("out.conf")});
    EXPECT_EQ(output.exit_code, 2);
    EXPECT_THAT(output.err, HasSubstr("allowed: .yml, .yaml"));
}

TEST_F(CalibrateTest, SaysWhichPartsOfTheImageHaveNoCorner) {
    make_views(4);  // the board in the upper left, mostly
    const Outcome outcome = calibrate({"--square", "30", "--report", path("report.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("verdict: repeat\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("[1-8] of 9 parts of the left eye's image have no corner"));
    EXPECT_THAT(outcome.err, testing::ContainsRegex("view 4 of 20, covered left [0-9]+ %, right [0-9]+ %; hold"));
    EXPECT_THAT(outcome.err, HasSubstr("hold the board into"));
    EXPECT_FALSE(cv::imread(path("report.png")).empty());
}

TEST_F(CalibrateTest, ReadsBoardsWithMarkers) {
    const calibration::Board charuco{6, 4, 40, calibration::BoardMarkers{calibration::marker_family("5x5"), 0.75}};
    make_views(13, charuco);
    const std::vector<std::string> options{"--square", "40", "--columns", "6", "--rows", "4", "--board", "charuco"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), options.begin(), options.end());
        return calibrate(more);
    };
    EXPECT_THAT(with({}).err, HasSubstr("--marker: is missing"));
    EXPECT_THAT(with({"--marker", "39"}).err, HasSubstr("allowed: 12.00 to 38.00"));
    EXPECT_THAT(with({"--marker", "30", "--dictionary", "7x7"}).err, HasSubstr("found '7x7'"));
    EXPECT_THAT(calibrate({"--square", "40", "--marker", "30"}).err, HasSubstr("a chessboard has no markers"));
    EXPECT_THAT(calibrate({"--square", "40", "--board", "go"}).err, HasSubstr("found 'go'"));
    EXPECT_THAT(
        calibrate({"--square", "40", "--columns", "40", "--rows", "40", "--board", "charuco", "--marker", "30"}).err,
        HasSubstr("allowed: 250"));
    EXPECT_THAT(with({"--marker", "30", "--dictionary", "6x6"}).err, HasSubstr("too little of the board"));

    const Outcome outcome = with({"--marker", "30", "--dictionary", "5x5", "--json", "--report", path("report.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_LT(nlohmann::json::parse(outcome.out)["rms_px"], 0.25);
    const auto read = calibration::read_calibration(path("out.yml"), width, height);
    EXPECT_NEAR(read.left.fx / capture::scene_calibration(width, height).left.fx, 1, 0.01);
    EXPECT_FALSE(cv::imread(path("report.png")).empty());
}

TEST_F(CalibrateTest, SaysWhatIsMissing) {
    make_views(2);
    const Outcome few = calibrate({"--square", "30"});
    EXPECT_EQ(few.exit_code, 2);
    EXPECT_THAT(few.err, HasSubstr("at least 3 are needed"));
    EXPECT_THAT(calibrate({"--square", "30", "--model", "omni"}).err, HasSubstr("--model: found 'omni'"));
    EXPECT_EQ(calibrate({"--square", "0"}).exit_code, 2);
    EXPECT_EQ(calibrate({}).exit_code, 2);
}

}  // namespace
}  // namespace disparityd::test
