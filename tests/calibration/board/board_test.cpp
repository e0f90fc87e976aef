// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/board.h"

#include <cmath>
#include <stdexcept>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibration/lens.h"
#include "capture/scene/scene_camera.h"
#include "tests/calibration/board/drawn_board.h"

namespace disparityd::calibration {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr int width = 640;
constexpr int height = 360;
const Board board{9, 6, 30};

const test::BoardPainter& painter() {
    static const test::BoardPainter painter(capture::scene_calibration(width, height), board);
    return painter;
}

std::optional<BoardView> seen(const test::Pose& pose) {
    const auto picture = painter().draw(pose);
    return find_board({picture.data(), width, height, 2 * width}, {picture.data() + width, width, height, 2 * width},
                      board);
}

const std::vector<BoardView>& careful_views() {
    static const std::vector<BoardView> views = test::careful_views(board, width, height);
    return views;
}

TEST(Board, CornersAreWhereTheCamerasSeeThem) {
    const StereoCalibration cameras = capture::scene_calibration(width, height);
    const test::Pose pose{{0.2, -0.3, 0.1}, {-60, -70, 700}};
    const auto view = seen(pose);
    ASSERT_TRUE(view);
    ASSERT_EQ(view->left.size(), 54U);
    std::vector<cv::Point3d> points;
    for (int i = 0; i < 54; ++i) {
        points.emplace_back(i % 9 * board.square_mm, i / 9 * board.square_mm, 0);
    }
    const CameraModel& left = cameras.left;
    const cv::Matx33d matrix(left.fx, 0, left.cx, 0, left.fy, left.cy, 0, 0, 1);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, pose.turn, pose.at, matrix, left.distortion, pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        // Whichever end the search has begun at.
        const std::size_t k = cv::norm(cv::Point2d(view->left[0]) - pixels[0]) < 5 ? i : pixels.size() - 1 - i;
        EXPECT_LT(cv::norm(cv::Point2d(view->left[k]) - pixels[i]), 0.35) << i;
    }
}

TEST(Board, ThatOnlyOneEyeSeesIsNoView) {
    const auto picture = painter().draw({{0, 0, 0}, {-60, -70, 600}});
    const Plane<const std::uint8_t> left{picture.data(), width, height, 2 * width};
    const std::vector<std::uint8_t> grey(static_cast<std::size_t>(width) * height, 90);
    const Plane<const std::uint8_t> empty{grey.data(), width, height, width};
    EXPECT_TRUE(find_board(left, left, board));
    EXPECT_FALSE(find_board(left, empty, board));
    EXPECT_FALSE(find_board(empty, left, board));
    EXPECT_FALSE(find_board(left, left, {11, 8, 30}));
}

TEST(BoardCalibration, FindsTheCamerasThatSawIt) {
    const StereoCalibration truth = capture::scene_calibration(width, height);
    ASSERT_GE(careful_views().size(), 11U);
    const BoardCalibration found = calibrate(careful_views(), board, width, height);
    EXPECT_LT(found.rms, 0.2);
    for (const auto& [got, wanted] :
         {std::pair(found.calibration.left, truth.left), std::pair(found.calibration.right, truth.right)}) {
        EXPECT_NEAR(got.fx / wanted.fx, 1, 0.01);
        EXPECT_NEAR(got.fy / wanted.fy, 1, 0.01);
        EXPECT_NEAR(got.cx, wanted.cx, 3);
        EXPECT_NEAR(got.cy, wanted.cy, 3);
    }
    EXPECT_NEAR(found.calibration.translation[0], truth.translation[0], 1);
    const cv::Matx33d difference =
        cv::Matx33d(found.calibration.rotation.data()) * cv::Matx33d(truth.rotation.data()).t();
    cv::Vec3d angles;
    cv::Rodrigues(difference, angles);
    EXPECT_LT(std::abs(angles[0]), 0.003);
    EXPECT_LT(std::abs(angles[2]), 0.001);
    ASSERT_EQ(found.views.size(), careful_views().size());
    for (const auto& view : found.views) {
        EXPECT_LT(view.left_rms, 0.2);
        EXPECT_LT(view.right_rms, 0.2);
        EXPECT_LT(view.rows, 0.2);
    }
}

/// What both cameras see of the board in many poses, without noise.
std::vector<BoardView> projected_views(const StereoCalibration& pair) {
    std::vector<cv::Point3d> points;
    std::vector<int> numbers;
    for (int i = 0; i < 54; ++i) {
        points.emplace_back(i % 9 * board.square_mm, i / 9 * board.square_mm, 0);
        numbers.push_back(i);
    }
    const Lens eyes[2] = {Lens(pair.left), Lens(pair.right)};
    std::vector<BoardView> views;
    for (int k = 0; k < 20; ++k) {
        cv::Matx33d turn;
        cv::Rodrigues(cv::Vec3d(0.5 * std::sin(k), 0.5 * std::cos(2.0 * k), 0.3 * std::sin(3.0 * k)), turn);
        const cv::Vec3d at(-120 + 180 * std::cos(k), -75 + 120 * std::sin(k), 330 + 40 * (k % 4));
        BoardView view{{}, {}, numbers};
        for (const cv::Point3d& point : points) {
            const cv::Vec3d left = turn * cv::Vec3d(point.x, point.y, point.z) + at;
            const cv::Vec3d right = cv::Matx33d(pair.rotation.data()) * left + cv::Vec3d(pair.translation.data());
            for (const auto& [lens, ray, corners] :
                 {std::tuple(&eyes[0], left, &view.left), {&eyes[1], right, &view.right}}) {
                const ImagePoint pixel = lens->pixel_of(ray[0], ray[1], ray[2]);
                corners->emplace_back(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
            }
        }
        views.push_back(view);
    }
    return views;
}

TEST(BoardCalibration, FindsRationalAndFisheyeLenses) {
    for (const BoardLens model : {BoardLens::rational, BoardLens::fisheye}) {
        StereoCalibration pair;
        pair.translation = {-80, 0.5, -0.25};
        const bool fisheye = model == BoardLens::fisheye;
        pair.left = {260, 261, 322, 238, {-0.03, 0.02, -0.01, 0.002}, LensModel::fisheye};
        pair.right = {262, 259, 318, 243, {-0.02, 0.015, -0.01, 0.001}, LensModel::fisheye};
        if (!fisheye) {
            pair.left = {260, 261, 322, 238, {0.4, 0.05, 0.001, -0.001, 0.002, 0.65, 0.13, 0.01}};
            pair.right = {262, 259, 318, 243, {0.38, 0.05, -0.001, 0.001, 0.002, 0.62, 0.12, 0.01}};
        }
        const std::vector<BoardView> views = projected_views(pair);
        const BoardCalibration found = calibrate(views, board, 640, 480, model);
        EXPECT_LT(found.rms, 0.1);
        EXPECT_EQ(found.calibration.left.lens, pair.left.lens);
        EXPECT_EQ(lens_coefficients(found.calibration.right).size(), fisheye ? 4U : 8U);
        EXPECT_NEAR(found.calibration.left.fx, 260, 1);
        EXPECT_NEAR(found.calibration.right.cy, 243, 1);
        EXPECT_NEAR(found.calibration.translation[0], -80, 0.5);
        EXPECT_LT(found.views[0].rows, 0.1);
        const ImagePoint truth = Lens(pair.left).pixel_of(0.7, -0.4, 1);
        const ImagePoint seen = Lens(found.calibration.left).pixel_of(0.7, -0.4, 1);
        EXPECT_NEAR(seen.x, truth.x, 0.5);
        EXPECT_NEAR(seen.y, truth.y, 0.5);
        if (!fisheye) {
            // Five coefficients do not describe this lens.
            EXPECT_GT(calibrate(views, board, 640, 480).rms, 2 * found.rms);
        }
    }
}

TEST(BoardCalibration, RefusesTooLittle) {
    EXPECT_THROW(calibrate({careful_views()[0], careful_views()[1]}, board, width, height), std::invalid_argument);
}

TEST(Moved, IsTheMeanWayOfTheCorners) {
    BoardView before{{{0, 0}, {10, 0}}, {}, {0, 1}};
    BoardView after{{{3, 4}, {10, 0}}, {}, {0, 1}};
    EXPECT_DOUBLE_EQ(moved(before, after), 2.5);
    EXPECT_DOUBLE_EQ(moved({{{0, 0}, {10, 0}, {20, 0}}, {}, {3, 5, 9}}, {{{1, 1}, {10, 4}}, {}, {4, 5}}), 4);
    EXPECT_TRUE(std::isinf(moved(before, {{{1, 1}}, {}, {7}})));
}

}  // namespace
}  // namespace disparityd::calibration
