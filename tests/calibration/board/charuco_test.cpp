// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/charuco.h"

#include <algorithm>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibration/board/coverage.h"
#include "capture/scene/scene_camera.h"
#include "tests/calibration/board/drawn_board.h"

namespace disparityd::calibration {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr int image_width = 640;
constexpr int image_height = 360;

Board charuco_board(int columns, int rows, const char* family = "4x4") {
    return {columns, rows, 40, BoardMarkers{marker_family(family), 0.75}};
}

test::BoardPainter painter_of(const Board& board, bool white_first = false) {
    return {capture::scene_calibration(image_width, image_height), board, white_first};
}

/// Both eyes of a drawn board.
struct Picture {
    Picture(const test::BoardPainter& painter, const test::Pose& pose) : both(painter.draw(pose)) {}

    cv::Mat left() { return {image_height, image_width, CV_8U, both.data(), 2 * image_width}; }
    cv::Mat right() { return {image_height, image_width, CV_8U, both.data() + image_width, 2 * image_width}; }
    std::optional<BoardView> view(const Board& board) const {
        return find_board({both.data(), image_width, image_height, 2 * image_width},
                          {both.data() + image_width, image_width, image_height, 2 * image_width}, board);
    }

    std::vector<std::uint8_t> both;
};

/// Where the left camera sees a corner.
cv::Point2d truth(const Board& board, const test::Pose& pose, int number) {
    const CameraModel left = capture::scene_calibration(image_width, image_height).left;
    const cv::Matx33d matrix(left.fx, 0, left.cx, 0, left.fy, left.cy, 0, 0, 1);
    const std::vector<cv::Point3d> point{
        {number % board.columns * board.square_mm, number / board.columns * board.square_mm, 0}};
    std::vector<cv::Point2d> pixel;
    cv::projectPoints(point, pose.turn, pose.at, matrix, left.distortion, pixel);
    return pixel[0];
}

void expect_true(const std::vector<NumberedCorner>& corners, const Board& board, const test::Pose& pose) {
    for (const NumberedCorner& corner : corners) {
        EXPECT_LT(cv::norm(cv::Point2d(corner.at) - truth(board, pose, corner.number)), 0.35) << corner.number;
    }
}

TEST(MarkerCodes, EveryMarkerIsReadInEveryTurn) {
    for (const char* name : {"4x4", "5x5", "6x6"}) {
        const MarkerFamily& family = *marker_family(name);
        for (std::size_t i = 0; i < family.codes.size(); ++i) {
            std::uint64_t bits = family.codes[i];
            for (int turns = 0; turns < 4; ++turns) {
                const auto reading = read_code(family, bits);
                ASSERT_TRUE(reading) << name << ' ' << i;
                EXPECT_EQ(reading->number, static_cast<int>(i)) << name;
                EXPECT_EQ(reading->turns, turns) << name << ' ' << i;
                // A quarter of a turn counter-clockwise.
                std::uint64_t turned = 0;
                for (int k = 0; k < family.side * family.side; ++k) {
                    const int from = k % family.side * family.side + family.side - 1 - k / family.side;
                    turned = turned << 1U | (bits >> static_cast<unsigned>(family.side * family.side - 1 - from) & 1U);
                }
                bits = turned;
            }
        }
    }
    EXPECT_EQ(marker_family("7x7"), nullptr);
}

TEST(MarkerCodes, WrongBitsAreToleratedOnlyAsFarAsThereIsNoDoubt) {
    for (const char* name : {"4x4", "5x5", "6x6"}) {
        const MarkerFamily& family = *marker_family(name);
        for (std::size_t i = 0; i < family.codes.size(); ++i) {
            const std::uint64_t wrong = (std::uint64_t{1} << static_cast<unsigned>(family.tolerated)) - 1;
            const auto reading = read_code(family, family.codes[i] ^ wrong);
            ASSERT_TRUE(reading) << name << ' ' << i;
            EXPECT_EQ(reading->number, static_cast<int>(i)) << name;
        }
    }
    EXPECT_FALSE(read_code(*marker_family("6x6"), 0));
}

TEST(Charuco, CornersAreWhereTheCameraSeesThem) {
    const test::Pose upright{{0.2, -0.3, 0.1}, {-70, -60, 420}};
    const test::Pose turned{{-0.1, 0.2, 2.5}, {100, 20, 420}};
    for (const auto& [family, pose] :
         {std::pair("4x4", upright), std::pair("5x5", turned), std::pair("6x6", upright)}) {
        const Board board = charuco_board(5, 4, family);
        Picture picture(painter_of(board), pose);
        const auto corners = find_charuco_corners(picture.left(), board);
        EXPECT_EQ(corners.size(), 20U) << family;
        expect_true(corners, board, pose);
    }
}

TEST(Charuco, PartOfTheBoardSuffices) {
    const Board board = charuco_board(6, 4);
    const test::Pose pose{{0.1, 0.2, 0.05}, {-90, -60, 480}};
    Picture picture(painter_of(board), pose);
    const auto whole = find_charuco_corners(picture.left(), board);
    ASSERT_EQ(whole.size(), 24U);
    // A hand over the right half, in each eye.
    const int edge = static_cast<int>((truth(board, pose, 3).x + truth(board, pose, 4).x) / 2);
    picture.left().colRange(edge, image_width).setTo(120);
    picture.right().colRange(edge, image_width).setTo(120);
    const auto seen = find_charuco_corners(picture.left(), board);
    EXPECT_GE(seen.size(), 8U);
    EXPECT_LT(seen.size(), 20U);
    expect_true(seen, board, pose);
    for (const NumberedCorner& corner : seen) {
        EXPECT_LT(corner.at.x, edge);
    }
    const auto view = picture.view(board);
    ASSERT_TRUE(view);
    EXPECT_GE(view->numbers.size(), 8U);
    EXPECT_EQ(view->numbers.size(), view->left.size());
    EXPECT_EQ(view->numbers.size(), view->right.size());
    EXPECT_TRUE(std::is_sorted(view->numbers.begin(), view->numbers.end()));
    // One column of corners tells nothing about the camera.
    picture.left().colRange(static_cast<int>(truth(board, pose, 1).x) + 8, image_width).setTo(120);
    EXPECT_FALSE(picture.view(board));
}

TEST(Charuco, BoardsOfOlderOpenCvHaveAMarkerUpperLeft) {
    const Board board = charuco_board(6, 3);
    const test::Pose pose{{0.1, -0.1, 0.05}, {-100, -40, 450}};
    for (const bool white_first : {false, true}) {
        Picture picture(painter_of(board, white_first), pose);
        const auto corners = find_charuco_corners(picture.left(), board);
        EXPECT_EQ(corners.size(), 18U) << white_first;
        expect_true(corners, board, pose);
    }
}

TEST(Charuco, NothingIsFoundWhereThereIsNone) {
    const Board board = charuco_board(6, 4);
    const test::Pose pose{{0.1, 0.2, 0.05}, {-90, -60, 480}};
    Picture plain(painter_of({6, 4, 40, {}}), pose);
    EXPECT_TRUE(find_charuco_corners(plain.left(), board).empty());
    Picture other(painter_of(charuco_board(6, 4, "6x6")), pose);
    EXPECT_TRUE(find_charuco_corners(other.left(), board).empty());
    const cv::Mat grey(image_height, image_width, CV_8U, cv::Scalar(90));
    EXPECT_TRUE(find_charuco_corners(grey, board).empty());
    EXPECT_TRUE(find_charuco_corners(cv::Mat(4, 3, CV_8U, cv::Scalar(0)), board).empty());
}

TEST(Charuco, CalibratesFromPartlyHiddenBoards) {
    const StereoCalibration cameras = capture::scene_calibration(image_width, image_height);
    const Board board = charuco_board(6, 4);
    const test::BoardPainter painter = painter_of(board);
    std::vector<BoardView> views;
    std::size_t partly = 0;
    for (const test::Pose& pose : test::careful_poses(board)) {
        auto both = painter.draw(pose);
        // Every other view has a hand over a part of the board, another one in each eye.
        cv::Mat picture(image_height, 2 * image_width, CV_8U, both.data());
        const auto at = truth(board, pose, 3);
        if (views.size() % 2 == 1) {
            const cv::Rect image(0, 0, image_width, image_height);
            const int x = static_cast<int>(at.x);
            const int y = static_cast<int>(at.y);
            picture.colRange(0, image_width)(cv::Rect(x, y - 20, 60, 50) & image).setTo(110);
            picture.colRange(image_width, 2 * image_width)(cv::Rect(x - 80, y + 10, 40, 50) & image).setTo(110);
        }
        const auto view = find_board({both.data(), image_width, image_height, 2 * image_width},
                                     {both.data() + image_width, image_width, image_height, 2 * image_width}, board);
        if (view) {
            views.push_back(*view);
            partly += view->numbers.size() < 24 ? 1 : 0;
        }
    }
    ASSERT_GE(views.size(), 11U);
    EXPECT_GE(partly, 4U);
    EXPECT_THAT(missing_views(views, board, image_width, image_height), Not(Contains(HasSubstr("tilt"))));
    const BoardCalibration found = calibrate(views, board, image_width, image_height);
    EXPECT_LT(found.rms, 0.25);
    EXPECT_NEAR(found.calibration.left.fx / cameras.left.fx, 1, 0.01);
    EXPECT_NEAR(found.calibration.right.fx / cameras.right.fx, 1, 0.01);
    EXPECT_NEAR(found.calibration.translation[0], cameras.translation[0], 1.5);
    ASSERT_EQ(found.views.size(), views.size());
}

}  // namespace
}  // namespace disparityd::calibration
