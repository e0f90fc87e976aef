// SPDX-License-Identifier: Apache-2.0
//
// Lenses against OpenCV's own functions, and to the bit against what other machines get.
#include "calibration/lens.h"

#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibration/rectification.h"
#include "tests/calibration/calibration_rigs.h"

namespace disparityd::calibration {
namespace {

constexpr std::array<double, 14> coefficients{-0.21,  0.05,    0.0004, -0.0003, 0.012,   0.13,  -0.02,
                                              0.0031, -0.0007, 0.0002, 0.0005,  -0.0001, 0.011, -0.007};

/// The first `count` of the coefficients, of a fisheye where there are four.
CameraModel lens_with(std::size_t count) {
    CameraModel camera{412.5, 409.25, 322.4, 236.8, {}};
    EXPECT_TRUE(set_lens_coefficients(camera, {coefficients.begin(), coefficients.begin() + static_cast<int>(count)}));
    return camera;
}

cv::Matx33d opencv_matrix(const CameraModel& camera) {
    return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

bool is_fisheye(const CameraModel& camera) {
    return camera.lens == LensModel::fisheye;
}

TEST(Lens, TakesRaysWhereOpenCvTakesThem) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> side(-1.2, 1.2);
    for (const std::size_t count : {4U, 5U, 8U, 12U, 14U}) {
        const CameraModel camera = lens_with(count);
        const Lens lens(camera);
        std::vector<cv::Point3d> rays{{0, 0, 2}};
        for (int i = 0; i < 200; ++i) {
            rays.emplace_back(side(random), side(random), i % 2 == 0 ? 1.0 : 2.5);
        }
        const auto used = lens_coefficients(camera);
        std::vector<cv::Point2d> expected;
        if (is_fisheye(camera)) {
            cv::fisheye::projectPoints(rays, expected, cv::Vec3d(), cv::Vec3d(), opencv_matrix(camera), used);
        } else {
            cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), opencv_matrix(camera), used, expected);
        }
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const ImagePoint found = lens.pixel_of(rays[i].x, rays[i].y, rays[i].z);
            EXPECT_NEAR(found.x, expected[i].x, 1e-9) << count;
            EXPECT_NEAR(found.y, expected[i].y, 1e-9) << count;
        }
        EXPECT_TRUE(std::isnan(lens.pixel_of(0.1, 0, 0).x));
        EXPECT_TRUE(std::isnan(lens.pixel_of(0.1, 0, -1).y));
    }
}

TEST(Lens, AFisheyeSeesAlmostToTheSide) {
    CameraModel camera{100, 100, 0, 0, {}, LensModel::fisheye};
    for (const double angle : {1e-9, 0.3, 0.7, 1.2, 1.5, 1.57}) {
        EXPECT_NEAR(Lens(camera).pixel_of(std::sin(angle), 0, std::cos(angle)).x, 100 * angle, 1e-11);
    }
}

/// The pixels' bits, one after the other.
std::uint64_t bits_of(const CameraModel& camera) {
    const Lens lens(camera);
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (int y = -40; y <= 40; ++y) {
        for (int x = -40; x <= 40; ++x) {
            const ImagePoint pixel = lens.pixel_of(x / 37.0, y / 41.0, 1.03125);
            for (const double value : {pixel.x, pixel.y}) {
                hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3ULL;
            }
        }
    }
    return hash;
}

TEST(Lens, EveryMachineGetsTheSameBits) {
    EXPECT_EQ(bits_of(lens_with(4)), 0xd607838e6ab2cda8ULL);
    EXPECT_EQ(bits_of(lens_with(5)), 0x2de83077c6a7abc5ULL);
    EXPECT_EQ(bits_of(lens_with(8)), 0x09ba0f8b3d95d5ebULL);
    EXPECT_EQ(bits_of(lens_with(14)), 0xe277ddad710e7915ULL);
}

/// A pair of such lenses, turned a little to each other.
StereoCalibration lens_pair(std::size_t count) {
    const test::Rig rig;
    StereoCalibration pair;
    pair.width = 640;
    pair.height = 480;
    pair.left = pair.right = lens_with(count);
    pair.right.cx += 3.5;
    pair.right.cy -= 2.25;
    const cv::Matx33d rotation = rig.rotation();
    std::copy(rotation.val, rotation.val + 9, pair.rotation.begin());
    pair.translation = {-120, 0.9, -0.6};
    pair.origin = "test";
    return pair;
}

/// How many entries differ from OpenCV's map; more than a step of 1/32 px fails.
int differing(const Rectification::Maps& maps, const cv::Mat& xy, const cv::Mat& fraction) {
    int count = 0;
    for (int i = 0; i < xy.rows * xy.cols; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const cv::Vec2s whole = xy.at<cv::Vec2s>(i / xy.cols, i % xy.cols);
        const int rest = fraction.at<std::uint16_t>(i / xy.cols, i % xy.cols);
        const int x = 32 * (maps.xy[2 * at] - whole[0]) + (maps.fraction[at] & 31) - (rest & 31);
        const int y = 32 * (maps.xy[2 * at + 1] - whole[1]) + (maps.fraction[at] >> 5) - (rest >> 5);
        EXPECT_LE(std::max(std::abs(x), std::abs(y)), 1);
        count += x != 0 || y != 0 ? 1 : 0;
    }
    return count;
}

TEST(Lens, MapsAreOpenCvs) {
    for (const std::size_t count : {4U, 5U, 8U, 12U, 14U}) {
        const StereoCalibration pair = lens_pair(count);
        const Rectification ours = make_rectification(pair, 640, 480, {});
        const cv::Matx33d projection(ours.f, 0, ours.cx, 0, ours.f, ours.cy, 0, 0, 1);
        for (const int eye : {0, 1}) {
            const CameraModel& camera = eye == 0 ? pair.left : pair.right;
            const cv::Matx33d turn((eye == 0 ? ours.left_rotation : ours.right_rotation).data());
            const auto used = lens_coefficients(camera);
            cv::Mat xy, fraction;
            if (is_fisheye(camera)) {
                cv::fisheye::initUndistortRectifyMap(opencv_matrix(camera), used, turn, projection, {640, 480},
                                                     CV_16SC2, xy, fraction);
            } else {
                cv::initUndistortRectifyMap(opencv_matrix(camera), used, turn, projection, {640, 480}, CV_16SC2, xy,
                                            fraction);
            }
            // Places between two steps may be rounded either way.
            EXPECT_LE(differing(eye == 0 ? ours.left : ours.right, xy, fraction), 4) << count;
        }
    }
}

}  // namespace
}  // namespace disparityd::calibration
