// SPDX-License-Identifier: Apache-2.0
#include "daemon/raw_cameras.h"

#include <vector>

#include <gtest/gtest.h>

namespace disparityd::daemon {
namespace {

constexpr Turns turns{{1, 2, 3, 4, 5, 6, 7, 8, 9}, {9, 8, 7, 6, 5, 4, 3, 2, 1}};

std::vector<double> distortion(const v1::RawCamera& camera) {
    return {camera.distortion().begin(), camera.distortion().end()};
}

calibration::StereoCalibration two_eyes() {
    calibration::StereoCalibration made;
    made.width = 640;
    made.height = 480;
    made.left = {.fx = 500, .fy = 501, .cx = 320, .cy = 240, .distortion = {0.1, 0.2, 0.3, 0.4}};
    made.right = {.fx = 502, .fy = 503, .cx = 321, .cy = 241, .distortion = {0, 0, 0, 0, 0, 0, 0.5}};
    return made;
}

TEST(RawCameras, HaveWhatTheCalibrationSays) {
    const auto made = raw_cameras(two_eyes(), turns);
    ASSERT_TRUE(made.has_value());
    EXPECT_EQ(made->width(), 640U);
    EXPECT_EQ(made->height(), 480U);
    EXPECT_EQ(made->left().fx(), 500);
    EXPECT_EQ(made->left().fy(), 501);
    EXPECT_EQ(made->left().cx(), 320);
    EXPECT_EQ(made->left().cy(), 240);
    EXPECT_EQ(made->left().lens(), "pinhole");
    EXPECT_EQ(distortion(made->left()), (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0}));
    EXPECT_EQ(std::vector<double>(made->left().rotation().begin(), made->left().rotation().end()),
              std::vector<double>(turns.left.begin(), turns.left.end()));
    EXPECT_EQ(made->right().fx(), 502);
    EXPECT_EQ(distortion(made->right()), (std::vector<double>{0, 0, 0, 0, 0, 0, 0.5, 0}));
    EXPECT_EQ(made->right().rotation(0), 9);
}

TEST(RawCameras, HaveAsManyCoefficientsAsTheModel) {
    calibration::StereoCalibration many = two_eyes();
    many.left.distortion[8] = 1;    // a thin prism
    many.right.distortion[13] = 1;  // a tilted sensor
    EXPECT_EQ(raw_cameras(many, turns)->left().distortion_size(), 12);
    EXPECT_EQ(raw_cameras(many, turns)->right().distortion_size(), 14);
    calibration::StereoCalibration wide = two_eyes();
    wide.left.lens = calibration::LensModel::fisheye;
    const auto made = raw_cameras(wide, turns);
    EXPECT_EQ(made->left().lens(), "fisheye");
    EXPECT_EQ(distortion(made->left()), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
}

TEST(RawCameras, AreNotThereForRectifiedImages) {
    calibration::StereoCalibration rectified = two_eyes();
    rectified.rectified = true;
    EXPECT_FALSE(raw_cameras(rectified, turns).has_value());
}

}  // namespace
}  // namespace disparityd::daemon
