// SPDX-License-Identifier: Apache-2.0
//
// Rectification against cv::remap for real calibrations, third-party data.
#include <cstdlib>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/rectification.h"
#include "calibration/rectified_camera.h"
#include "calibration/zed_modes.h"
#include "kernels/reference/steps.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/data_folder.h"

namespace disparityd::calibration {
namespace {

namespace fs = std::filesystem;

/// Noise, side by side: every pixel that is taken from a wrong place, or weighted wrongly, shows.
cv::Mat noise(int eye_width, int height) {
    cv::Mat image(height, 2 * eye_width, CV_8U);
    std::mt19937 random(5);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random() >> 24U);
        }
    }
    return image;
}

cv::Matx33d matrix_of(const CameraModel& camera) {
    return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

/// OpenCV's own way from a rectified camera to rectified eyes, and ours: not a byte apart. The camera is compared in
/// rectified_camera_test.cpp.
void expect_remap(const StereoCalibration& calibration) {
    const cv::Size size(calibration.width, calibration.height);
    const cv::Mat raw = noise(size.width, size.height);
    const Rectification ours = make_rectification(calibration, size.width, size.height, {});
    const Rectifier rectifier = ours.rectifier();
    const RectifiedCamera rectified = rectified_camera(calibration, size.width, size.height);
    const cv::Matx33d projection(rectified.f, 0, rectified.cx, 0, rectified.f, rectified.cy, 0, 0, 1);
    for (const int eye : {0, 1}) {
        cv::Mat xy, fraction, expected;
        const CameraModel& camera = eye == 0 ? calibration.left : calibration.right;
        cv::initUndistortRectifyMap(matrix_of(camera), camera.distortion, cv::Matx33d(rectified.turn[eye].data()),
                                    projection, size, CV_16SC2, xy, fraction);
        cv::remap(raw(cv::Rect(eye * size.width, 0, size.width, size.height)).clone(), expected, xy, fraction,
                  cv::INTER_LINEAR, cv::BORDER_CONSTANT);
        cv::Mat found(size, CV_8U);
        reference::rectify({raw.data, PixelFormat::grey8, size.width, size.height, 2 * size.width},
                           eye == 0 ? Eye::left : Eye::right, rectifier,
                           {found.data, size.width, size.height, size.width}, {0, size.height});
        EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0) << calibration.origin << ", eye " << eye;
    }
}

/// As it is, and with k3 and without whatever the file says.
void expect_remap_with_and_without_k3(StereoCalibration calibration) {
    expect_remap(calibration);
    for (const double k3 : {0.0, -0.02, 0.02}) {
        calibration.left.distortion[4] = k3;
        calibration.right.distortion[4] = k3;
        expect_remap(calibration);
    }
}

TEST(RectificationOfRealCameras, EqualsRemapForEachZedAndMode) {
    const fs::path folder = disparityd::test::data_folder() / "zed";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << "no calibrations in " << folder << "; DISPARITYD_DATA names the folder";
    }
    int tested = 0;
    for (const char* name : {"SN5867575.conf", "SN21531_derived.conf"}) {
        for (const ZedMode& mode : zed_modes) {
            try {
                expect_remap_with_and_without_k3(read_calibration((folder / name).string(), mode.width, mode.height));
                ++tested;
            } catch (const std::invalid_argument&) {
                // The derived file has no sections for 2K and VGA.
                EXPECT_STREQ(name, "SN21531_derived.conf");
            }
        }
    }
    EXPECT_GE(tested, 5);
}

TEST(RectificationOfRealCameras, EqualsRemapForOpenCvsOwnPair) {
    const fs::path intrinsics = disparityd::test::data_folder() / "opencv_calib" / "intrinsics.yml";
    if (!fs::exists(intrinsics)) {
        GTEST_SKIP() << "no " << intrinsics << "; DISPARITYD_DATA names the folder";
    }
    // It comes without R and T: those of a pair side by side, a little turned.
    const capture::test::TemporaryFolder folder;
    capture::test::write_file(
        folder.file("extrinsics.yml"),
        "%YAML:1.0\n---\nR: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0.99998, -0.004, "
        "0.005, 0.00402, 0.99999, -0.002, -0.00499, 0.00202, 0.99999 ]\nT: !!opencv-matrix\n   rows: 3\n   "
        "cols: 1\n   dt: d\n   data: [ -83., 1., 0.1 ]\n");
    expect_remap_with_and_without_k3(
        read_calibration(intrinsics.string() + "," + folder.file("extrinsics.yml"), 640, 480));
}

}  // namespace
}  // namespace disparityd::calibration
