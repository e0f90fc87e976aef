// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "calibration/calibration.h"
#include "calibration/rotation.h"

namespace disparityd::calibration::test {

/// A pair of raw cameras, and what OpenCV makes of it.
struct Rig {
    int width = 640;
    int height = 480;
    std::array<double, 4> left{531.2, 530.7, 322.4, 241.8};  ///< fx fy cx cy
    std::array<double, 4> right{532.0, 531.6, 318.9, 238.5};
    std::array<double, 5> left_distortion{-0.28, 0.09, 0.0004, -0.0003, -0.011};
    std::array<double, 5> right_distortion{-0.27, 0.08, -0.0002, 0.0005, -0.01};
    cv::Vec3d turn{0.004, -0.006, 0.003};  ///< rotation vector
    cv::Vec3d translation{-120, 0.9, -0.6};

    cv::Matx33d left_matrix() const { return {left[0], 0, left[2], 0, left[1], left[3], 0, 0, 1}; }
    cv::Matx33d right_matrix() const { return {right[0], 0, right[2], 0, right[1], right[3], 0, 0, 1}; }
    cv::Matx33d rotation() const {
        cv::Matx33d matrix;
        cv::Rodrigues(turn, matrix);
        return matrix;
    }
};

inline StereoCalibration calibration_of(const Rig& rig) {
    StereoCalibration calibration;
    calibration.width = rig.width;
    calibration.height = rig.height;
    calibration.left = {rig.left[0], rig.left[1], rig.left[2], rig.left[3], {}};
    calibration.right = {rig.right[0], rig.right[1], rig.right[2], rig.right[3], {}};
    std::copy(rig.left_distortion.begin(), rig.left_distortion.end(), calibration.left.distortion.begin());
    std::copy(rig.right_distortion.begin(), rig.right_distortion.end(), calibration.right.distortion.begin());
    const cv::Matx33d rotation = rotation_about(rig.turn);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(rig.translation.val, rig.translation.val + 3, calibration.translation.begin());
    return calibration;
}

/// Three cameras: one like a webcam, one wide and turned, one of a car.
inline std::vector<Rig> rigs() {
    Rig wide;
    wide.width = 1280;
    wide.height = 720;
    wide.left = {698.5, 697.1, 652.2, 351.7};
    wide.right = {701.3, 700.4, 631.8, 368.9};
    wide.left_distortion = {-0.172, 0.027, 0.00013, -0.00013, 0};
    wide.right_distortion = {-0.171, 0.026, 0.00005, 0.0002, 0};
    wide.turn = {-0.009, 0.012, -0.002};
    wide.translation = {-62.9, -0.2, 0.4};
    Rig car;
    car.width = 1242;
    car.height = 375;
    car.left = {984.2, 980.8, 690.1, 183.3};
    car.right = {989.5, 987.9, 672.3, 196.5};
    car.left_distortion = {-0.37, 0.2, 0.001, 0.0017, -0.07};
    car.right_distortion = {-0.36, 0.19, 0.0004, -0.0002, -0.06};
    car.turn = {0.013, -0.02, 0.001};
    car.translation = {-537.2, 5.9, -12.5};
    return {Rig(), wide, car};
}

/// OpenCV's own rectification of a rig.
struct Rectified {
    cv::Mat turn[2], projection[2], to_depth;
    explicit Rectified(const Rig& rig) {
        cv::stereoRectify(rig.left_matrix(), rig.left_distortion, rig.right_matrix(), rig.right_distortion,
                          {rig.width, rig.height}, rig.rotation(), rig.translation, turn[0], turn[1], projection[0],
                          projection[1], to_depth, cv::CALIB_ZERO_DISPARITY, 0);
    }
    double f() const { return projection[0].at<double>(0, 0); }
    double baseline() const { return -projection[1].at<double>(0, 3) / f(); }
};

}  // namespace disparityd::calibration::test
