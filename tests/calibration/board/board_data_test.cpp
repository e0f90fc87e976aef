// SPDX-License-Identifier: Apache-2.0
//
// OpenCV's own 13 pairs of a chessboard.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/board/board.h"
#include "tests/data_folder.h"

namespace disparityd::calibration {
namespace {

namespace fs = std::filesystem;

Plane<const std::uint8_t> plane(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0])};
}

TEST(BoardPairs, ReachTheErrorOfStereoCalibrate) {
    const fs::path folder = disparityd::test::data_folder() / "opencv_calib";
    if (!fs::exists(folder / "left01.jpg")) {
        GTEST_SKIP() << "no pairs in " << folder << "; DISPARITYD_DATA names the folder";
    }
    const Board board{9, 6, 25};
    std::vector<BoardView> views;
    int pairs = 0;
    for (int i = 1; i <= 14; ++i) {
        char number[8];
        std::snprintf(number, sizeof number, "%02d.jpg", i);
        const cv::Mat left = cv::imread((folder / (std::string("left") + number)).string(), cv::IMREAD_GRAYSCALE);
        const cv::Mat right = cv::imread((folder / (std::string("right") + number)).string(), cv::IMREAD_GRAYSCALE);
        if (left.empty() || right.empty()) {
            continue;
        }
        ++pairs;
        if (const auto view = find_board(plane(left), plane(right), board)) {
            views.push_back(*view);
        }
    }
    EXPECT_EQ(pairs, 13);
    ASSERT_EQ(views.size(), 13U);
    const BoardCalibration found = calibrate(views, board, 640, 480);
    EXPECT_LT(found.rms, 0.645);
    EXPECT_NEAR(found.calibration.left.fx, 534.8, 8);  // what comes with the pairs
    EXPECT_NEAR(found.calibration.right.fx, 534.8, 8);
    EXPECT_LT(found.calibration.translation[0], -70);
}

}  // namespace
}  // namespace disparityd::calibration
