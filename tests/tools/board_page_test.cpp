// SPDX-License-Identifier: Apache-2.0
//
// The board that disparityctl prints, as another program's renderer shows it.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/board/board.h"
#include "calibration/board/charuco.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

constexpr double dots_per_mm = 200 / 25.4;

class BoardPageTest : public FolderTest {
protected:
    Outcome write_page(std::vector<std::string> options) const {
        std::vector<std::string> arguments{"board", "-o", path("board.pdf"), "--force"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run(DISPARITYCTL, arguments);
    }

    std::string page() const {
        std::ifstream file(path("board.pdf"), std::ios::binary);
        std::ostringstream text;
        text << file.rdbuf();
        return text.str();
    }

    static bool has_renderer() { return std::system("command -v pdftoppm >/dev/null 2>&1") == 0; }

    /// The page as Poppler draws it, grey.
    cv::Mat rendered() const {
        const std::string command = "pdftoppm -r 200 -gray -singlefile " + path("board.pdf") + " " + path("board");
        EXPECT_EQ(std::system(command.c_str()), 0);
        return cv::imread(path("board.pgm"), cv::IMREAD_GRAYSCALE);
    }
};

/// The mean side of a square by its corners, row by row; mm.
double square_mm(const std::vector<cv::Point2f>& corners, int columns) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
        if ((i + 1) % static_cast<std::size_t>(columns) != 0) {
            sum += cv::norm(corners[i + 1] - corners[i]);
            ++count;
        }
    }
    return sum / count / dots_per_mm;
}

/// From the first to the last dark pixel of the bar below the board; mm.
double bar_mm(const cv::Mat& page) {
    double longest = 0;
    for (int y = page.rows - static_cast<int>(20 * dots_per_mm); y < page.rows; ++y) {
        int run = 0;
        for (int x = 0; x < page.cols; ++x) {
            run = page.at<std::uint8_t>(y, x) < 128 ? run + 1 : 0;
            longest = std::max(longest, run / dots_per_mm);
        }
    }
    return longest;
}

TEST_F(BoardPageTest, IsAPdfWhoseTableNamesThePlaceOfEachObject) {
    const Outcome outcome = write_page({});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("disparityctl calibrate SOURCE -o my.yml --columns 9 --rows 6 --square 25\n"));
    const std::string file = page();
    ASSERT_THAT(file, testing::StartsWith("%PDF-1.6\n"));
    const std::size_t start = std::stoul(file.substr(file.find("startxref\n") + 10));
    ASSERT_EQ(file.compare(start, 9, "xref\n0 6\n"), 0);
    for (std::size_t object = 1; object < 6; ++object) {
        const std::string row = file.substr(start + 9 + 20 * object, 20);
        const std::string begin = std::to_string(object) + " 0 obj\n";
        EXPECT_EQ(file.compare(std::stoul(row), begin.size(), begin), 0) << row;
    }
    EXPECT_THAT(file, HasSubstr("/MediaBox [0 0 841.8898 595.2756]"));
    write_page({});
    EXPECT_EQ(page(), file);
    EXPECT_EQ(run(DISPARITYCTL, {"board", "-o", path("board.pdf")}).exit_code, 2) << "a file is not replaced";
}

TEST_F(BoardPageTest, AChessboardIsFoundAndHasTheSizeThatItSays) {
    if (!has_renderer()) {
        GTEST_SKIP() << "pdftoppm is not installed (poppler-utils)";
    }
    for (const auto& [paper, square] : {std::pair{"a4", "25"}, {"letter", "25"}, {"a4", "20.5"}}) {
        ASSERT_EQ(write_page({"--paper", paper, "--square", square}).exit_code, 0);
        const cv::Mat image = rendered();
        ASSERT_FALSE(image.empty());
        std::vector<cv::Point2f> corners;
        ASSERT_TRUE(cv::findChessboardCornersSB(image, {9, 6}, corners)) << paper;
        EXPECT_NEAR(square_mm(corners, 9), std::atof(square), 0.02) << "by OpenCV, " << paper;
        const Plane<const std::uint8_t> plane{image.data, image.cols, image.rows,
                                              static_cast<std::ptrdiff_t>(image.step)};
        const auto view = calibration::find_board(plane, plane, {9, 6, 25, {}});
        ASSERT_TRUE(view) << paper;
        EXPECT_NEAR(square_mm(view->left, 9), std::atof(square), 0.02) << paper;
        EXPECT_NEAR(bar_mm(image), 100, 0.15) << paper;
    }
}

TEST_F(BoardPageTest, EveryCornerOfACharucoBoardIsFound) {
    if (!has_renderer()) {
        GTEST_SKIP() << "pdftoppm is not installed (poppler-utils)";
    }
    for (const char* dictionary : {"4x4", "5x5", "6x6"}) {
        ASSERT_EQ(write_page({"--board", "charuco", "--dictionary", dictionary, "--paper", "letter"}).exit_code, 0);
        const cv::Mat image = rendered();
        ASSERT_FALSE(image.empty());
        const calibration::Board board{9, 6, 25,
                                       calibration::BoardMarkers{calibration::marker_family(dictionary), 18.0 / 25}};
        const auto found = calibration::find_charuco_corners(image, board);
        ASSERT_EQ(found.size(), 54U) << dictionary;
        std::vector<cv::Point2f> corners;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].number, static_cast<int>(i));
            corners.push_back(found[i].at);
        }
        EXPECT_NEAR(square_mm(corners, 9), 25, 0.02) << dictionary;
        EXPECT_NEAR(bar_mm(image), 100, 0.15);
    }
}

TEST_F(BoardPageTest, WhatDoesNotFitOrCannotBeFoundIsRefused) {
    const std::pair<std::vector<std::string>, const char*> mistakes[] = {
        {{"--square", "30"},
         "the board has 300.0 x 210.0 mm, the paper has room for 277.0 x 178.0 mm: allowed is up to"},
        {{"--paper", "a0"}, "--paper: found 'a0', allowed: a4 or letter"},
        {{"--square", "0.5"}, "--square: found 0.50, allowed: 1 to 1000"},
        {{"--board", "charuco", "--marker", "24.9"}, "--marker: found 24.90, allowed: 7.50 to 23.75 mm"},
    };
    for (const auto& [options, part] : mistakes) {
        const Outcome outcome = write_page(options);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr(part));
    }
    EXPECT_THAT(run(DISPARITYCTL, {"board", "-o", path("board.png")}).err, HasSubstr(".pdf"));
}

}  // namespace
}  // namespace disparityd::test
