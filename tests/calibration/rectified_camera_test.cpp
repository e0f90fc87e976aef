// SPDX-License-Identifier: Apache-2.0
//
// The rectified camera against OpenCV's stereoRectify, and to the bit against what other machines get.
#include "calibration/rectified_camera.h"

#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibration/lens.h"
#include "calibration/rotation.h"
#include "tests/calibration/calibration_rigs.h"

namespace disparityd::calibration {
namespace {

using test::calibration_of;
using test::Rig;

/// Rigs with lenses of all models, rotations with rounded digits, and an eye that stands on the other side.
std::vector<StereoCalibration> calibrations() {
    std::vector<StereoCalibration> all;
    for (const Rig& rig : test::rigs()) {
        all.push_back(calibration_of(rig));
        StereoCalibration rounded = all.back();
        for (double& value : rounded.rotation) {
            value = std::round(value * 1e4) / 1e4;
        }
        rounded.translation[0] = -rounded.translation[0];
        all.push_back(rounded);
        StereoCalibration tilted = all.back();
        tilted.left.distortion = {-0.21,  0.05,    0.0004, -0.0003, 0.012,   0.13,  -0.02,
                                  0.0031, -0.0007, 0.0002, 0.0005,  -0.0001, 0.011, -0.007};
        tilted.right.distortion = {-0.2, 0.04, 0.0001, -0.0002, 0.01, 0.1, -0.01, 0.002};
        all.push_back(tilted);
    }
    return all;
}

/// Later ones take the last pixel of a border where 4.6 takes the end of the image.
constexpr bool has_the_same_f = CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR <= 6;

TEST(RectifiedCamera, IsThatOfOpenCv) {
    for (const StereoCalibration& calibration : calibrations()) {
        for (const cv::Size size : {cv::Size(calibration.width, calibration.height), cv::Size(801, 500)}) {
            const auto matrix = [](const CameraModel& of) {
                return cv::Matx33d(of.fx, 0, of.cx, 0, of.fy, of.cy, 0, 0, 1);
            };
            cv::Mat turn[2], projection[2], to_depth;
            cv::stereoRectify(matrix(calibration.left), calibration.left.distortion, matrix(calibration.right),
                              calibration.right.distortion, {calibration.width, calibration.height},
                              cv::Matx33d(calibration.rotation.data()), cv::Vec3d(calibration.translation.data()),
                              turn[0], turn[1], projection[0], projection[1], to_depth, cv::CALIB_ZERO_DISPARITY, 0,
                              size);
            const RectifiedCamera camera = rectified_camera(calibration, size.width, size.height);
            const double f = projection[0].at<double>(0, 0);
            EXPECT_NEAR(camera.f, f, has_the_same_f ? 1e-9 : 0.01 * f);
            EXPECT_NEAR(camera.cx, projection[0].at<double>(0, 2), 1e-9);
            EXPECT_NEAR(camera.cy, projection[0].at<double>(1, 2), 1e-9);
            EXPECT_NEAR(camera.baseline_mm, -projection[1].at<double>(0, 3) / f, 1e-9);
            for (const int eye : {0, 1}) {
                EXPECT_LT(cv::norm(cv::Matx33d(camera.turn[eye].data()), cv::Matx33d(turn[eye])), 1e-11);
            }
        }
    }
}

TEST(RectifiedCamera, KnowsNoBaselineOfEyesAboveEachOther) {
    StereoCalibration calibration = calibration_of(Rig());
    calibration.translation = {1, 120, 0};
    EXPECT_EQ(rectified_camera(calibration, 640, 480).baseline_mm, 0);
    calibration.translation = {};
    EXPECT_EQ(rectified_camera(calibration, 640, 480).baseline_mm, 0);
}

TEST(RectifiedCamera, HasTheSameBitsOnEveryMachine) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    const auto add = [&](double value) { hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3ULL; };
    for (StereoCalibration& calibration : calibrations()) {
        // In few digits, as a sine of the C library may differ in the last one.
        for (double& value : calibration.rotation) {
            value = std::round(value * 1e6) / 1e6;
        }
        const RectifiedCamera camera = rectified_camera(calibration, calibration.width, calibration.height);
        for (const double value : {camera.f, camera.cx, camera.cy, camera.baseline_mm}) {
            add(value);
        }
        for (const auto& turn : camera.turn) {
            for (const double value : turn) {
                add(value);
            }
        }
    }
    EXPECT_EQ(hash, 5894231440770901627U);
}

TEST(Rotation, IsThatOfOpenCvsRodrigues) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> side(-2, 2);
    for (int i = 0; i < 100; ++i) {
        const cv::Vec3d vector = i == 0 ? cv::Vec3d() : cv::Vec3d(side(random), side(random), side(random));
        cv::Matx33d expected;
        cv::Rodrigues(vector, expected);
        EXPECT_LT(cv::norm(rotation_about(vector), expected), 1e-14);
        const double length = cv::norm(vector);
        if (length < 3) {
            EXPECT_LT(cv::norm(half_rotation(expected), rotation_about(0.5 * vector)), 1e-13) << length;
        }
    }
}

TEST(Lens, TakesPixelsBackAlongTheirRays) {
    for (const StereoCalibration& calibration : calibrations()) {
        const Lens lens(calibration.left);
        const ImagePoint middle{calibration.left.cx + 0.1 * calibration.left.fx, calibration.left.cy};
        const ImagePoint ray = lens.ray_of(middle);
        const ImagePoint pixel = lens.pixel_of(ray.x, ray.y, 1);
        EXPECT_NEAR(pixel.x, middle.x, 1e-3);
        EXPECT_NEAR(pixel.y, middle.y, 1e-3);
    }
}

}  // namespace
}  // namespace disparityd::calibration
