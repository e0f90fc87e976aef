// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectification.h"

#include <cmath>

#include <opencv2/calib3d.hpp>

#include "capture/scene/scene_camera.h"
#include "tests/capture/images/image_fixture.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using testing::AllOf;
using testing::HasSubstr;

/// Where a map of a rectified pixel points to in the captured image.
cv::Point2d mapped(const RectifyMap& map, int x, int y) {
    const int fraction = map.fraction.at(x, y);
    return {map.xy.at(2 * x, y) + (fraction & 31) / 32.0, map.xy.at(2 * x + 1, y) + (fraction >> 5) / 32.0};
}

/// The same for a place between two columns.
cv::Point2d mapped(const RectifyMap& map, double x, int y) {
    const int column = static_cast<int>(std::floor(x));
    const double part = x - column;
    return (1 - part) * mapped(map, column, y) + part * mapped(map, column + 1, y);
}

cv::Point2d projected(const CameraModel& camera, cv::Vec3d point) {
    const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    const std::vector<cv::Point3d> points{{point[0], point[1], point[2]}};
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, camera.distortion, pixels);
    return pixels[0];
}

/// Points of the room, given by a pixel and a depth of the rectified left image, lie at that pixel in the left map,
/// and on the same row f B / Z to the left in the right map: within 0.05 px and the maps' own step of 1/32 px.
void expect_epipolar(const StereoCalibration& calibration, const Rectification& rectification) {
    const Rectifier rectifier = rectification.rectifier();
    ASSERT_TRUE(rectifier.mapped);
    const cv::Matx33d turn(rectification.left_rotation.data());
    const cv::Matx33d rotation(calibration.rotation.data());
    const cv::Vec3d translation(calibration.translation.data());
    constexpr double tolerance = 0.05 + 1.0 / 32;
    int tested = 0;
    for (int y = 3; y < rectification.height; y += 37) {
        for (int x = 2; x < rectification.width; x += 41) {
            for (const double depth : {700.0, 2000.0, 15000.0}) {
                const double disparity = rectification.f * rectification.baseline_mm / depth;
                if (x - disparity < 0) {
                    continue;
                }
                const cv::Vec3d seen(depth * (x - rectification.cx) / rectification.f,
                                     depth * (y - rectification.cy) / rectification.f, depth);
                const cv::Vec3d left = turn.t() * seen;
                const cv::Point2d in_left = mapped(rectifier.left, x, y) - projected(calibration.left, left);
                const cv::Point2d in_right = mapped(rectifier.right, x - disparity, y) -
                                             projected(calibration.right, rotation * left + translation);
                EXPECT_LT(cv::norm(in_left), tolerance) << x << " " << y;
                EXPECT_LT(std::abs(in_right.y), tolerance) << x << " " << y << " at " << depth;
                EXPECT_LT(std::abs(in_right.x), tolerance) << x << " " << y << " at " << depth;
                ++tested;
            }
        }
    }
    EXPECT_GT(tested, 50);
}

StereoCalibration plain_rectified(int width, int height) {
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.rectified = true;
    calibration.left = {100, 100, 20, 10, {}};
    calibration.right = {100, 100, 23.5, 10, {}};
    calibration.translation = {-200, 0, 0};
    calibration.origin = "calib.txt";
    return calibration;
}

TEST(Rectification, CorrespondingPointsLieOnOneRowAtFocalTimesBaselineOverDepth) {
    const StereoCalibration calibration = capture::scene_calibration(672, 376);
    const Rectification rectification = make_rectification(calibration, 672, 376, {});
    EXPECT_EQ(rectification.width, 672);
    EXPECT_EQ(rectification.height, 376);
    EXPECT_NEAR(rectification.baseline_mm, 119.8, 0.01);
    EXPECT_FALSE(rectification.unrectified);
    EXPECT_EQ(rectification.disparity_offset, 0);
    expect_epipolar(calibration, rectification);
}

TEST(Rectification, AnotherSizeKeepsTheFieldOfViewAndARegionShiftsTheCentre) {
    const StereoCalibration calibration = capture::scene_calibration(672, 376);
    const Rectification whole = make_rectification(calibration, 672, 376, {});
    const Rectification half = make_rectification(calibration, 672, 376, {336, 188, {}});
    EXPECT_NEAR(half.f / whole.f, 0.5, 0.02);
    expect_epipolar(calibration, half);
    const Rectification part = make_rectification(calibration, 672, 376, {672, 376, {100, 50, 301, 203}});
    EXPECT_EQ(part.width, 301);
    EXPECT_EQ(part.height, 203);
    EXPECT_EQ(part.f, whole.f);
    EXPECT_EQ(part.cx, whole.cx - 100);
    EXPECT_EQ(part.cy, whole.cy - 50);
    expect_epipolar(calibration, part);
    EXPECT_EQ(mapped(part.rectifier().right, 7, 9), mapped(whole.rectifier().right, 107, 59));
}

TEST(Rectification, RectifiedImagesAreOnlyCut) {
    const Rectification whole = make_rectification(plain_rectified(41, 21), 41, 21, {});
    EXPECT_FALSE(whole.rectifier().mapped);
    EXPECT_FALSE(whole.unrectified);
    EXPECT_EQ(whole.f, 100);
    EXPECT_EQ(whole.baseline_mm, 200);
    EXPECT_EQ(whole.disparity_offset, 3.5);
    EXPECT_EQ(whole.depth_scale().k, 16 * 100 * 200);
    EXPECT_EQ(whole.depth_scale().offset16, 56);
    const Rectification part = make_rectification(plain_rectified(41, 21), 41, 21, {41, 21, {5, 6, 30, 7}});
    EXPECT_FALSE(part.rectifier().mapped);
    EXPECT_EQ(part.rectifier().crop_x, 5);
    EXPECT_EQ(part.rectifier().crop_y, 6);
    EXPECT_EQ(part.width, 30);
    EXPECT_EQ(part.cx, 15);
    EXPECT_EQ(part.disparity_offset, 3.5);
}

TEST(Rectification, RectifiedImagesOfAnotherSizeAreScaled) {
    const Rectification twice = make_rectification(plain_rectified(40, 20), 40, 20, {80, 40, {}});
    ASSERT_TRUE(twice.rectifier().mapped);
    EXPECT_EQ(twice.f, 200);
    EXPECT_EQ(twice.disparity_offset, 7);
    EXPECT_EQ(twice.cx, 40.5);  // pixel centres: 20 + 1/2 of 40 is 40 + 1/2 + 1/2 of 80
    // The middle of rectified pixel 21 is the place 10.25 of the captured image.
    EXPECT_NEAR(mapped(twice.rectifier().left, 21, 11).x, 10.25, 1.0 / 32);
    EXPECT_NEAR(mapped(twice.rectifier().right, 21, 11).y, 5.25, 1.0 / 32);
}

TEST(Rectification, WithoutCalibrationThePixelsStay) {
    const Rectification raw = make_rectification(std::nullopt, 41, 21, {});
    EXPECT_TRUE(raw.unrectified);
    EXPECT_FALSE(raw.rectifier().mapped);
    EXPECT_EQ(raw.width, 41);
    EXPECT_EQ(raw.depth_scale().k, 0);
    StereoCalibration known = plain_rectified(41, 21);
    known.left = {};
    known.right = {};
    known.translation = {};
    const Rectification rectified = make_rectification(known, 41, 21, {});
    EXPECT_FALSE(rectified.unrectified);
    EXPECT_EQ(rectified.f, 0);
    EXPECT_EQ(rectified.depth_scale().k, 0);
}

TEST(Rectification, IdTellsMapsAndGeometryApart) {
    const StereoCalibration calibration = capture::scene_calibration(320, 180);
    const auto id = [](const StereoCalibration& c, const RectifiedGeometry& g) {
        return make_rectification(c, c.width, c.height, g).calibration_id;
    };
    const std::uint64_t first = id(calibration, {});
    EXPECT_EQ(first, id(calibration, {}));
    EXPECT_EQ(first, id(calibration, {320, 180, {0, 0, 320, 180}}));
    EXPECT_NE(first, id(calibration, {320, 180, {0, 1, 320, 179}}));
    EXPECT_NE(first, id(calibration, {160, 90, {}}));
    StereoCalibration other = calibration;
    other.translation[0] -= 0.5;
    EXPECT_NE(first, id(other, {}));
    EXPECT_NE(id(plain_rectified(40, 20), {40, 20, {0, 0, 9, 9}}), id(plain_rectified(40, 20), {40, 20, {1, 0, 9, 9}}));
}

TEST(RectificationRefuses, WhatDoesNotFit) {
    const StereoCalibration calibration = capture::scene_calibration(320, 180);
    EXPECT_THAT(refusal([&] { make_rectification(calibration, 672, 376, {}); }),
                AllOf(HasSubstr("320x180"), HasSubstr("672x376")));
    for (const RectifiedGeometry& geometry : {RectifiedGeometry{-1, 10, {}},
                                              {10, 0, {}},
                                              {9000, 10, {}},
                                              {320, 180, {300, 0, 30, 30}},
                                              {320, 180, {-1, 0, 30, 30}},
                                              {320, 180, {0, 0, 0, 30}},
                                              {320, 180, {1, 1, 0, 0}},
                                              {320, 180, {2147483647, 0, 2147483647, 1}}}) {
        EXPECT_THAT(refusal([&] { make_rectification(calibration, 320, 180, geometry); }), HasSubstr("rectified"));
    }
    StereoCalibration backwards = calibration;
    backwards.rotation = {-1, 0, 0, 0, 1, 0, 0, 0, -1};
    EXPECT_THAT(refusal([&] { make_rectification(backwards, 320, 180, {}); }), HasSubstr("scene"));
}

}  // namespace
}  // namespace disparityd::calibration
