// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/pose_agreement.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace disparityd::calibration {

namespace {

constexpr double degrees_of_radian = 180 / std::numbers::pi;

}  // namespace

double degrees_between(const cv::Matx33d& a, const cv::Matx33d& b) {
    // Sine and cosine together: the arc cosine alone loses small angles.
    const cv::Matx33d turn = a * b.t();
    const cv::Vec3d axis(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
    return std::atan2(0.5 * cv::norm(axis), 0.5 * (cv::trace(turn) - 1)) * degrees_of_radian;
}

double degrees_between(const cv::Vec3d& a, const cv::Vec3d& b) {
    if (!(cv::norm(a) > 0) || !(cv::norm(b) > 0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return std::atan2(cv::norm(a.cross(b)), a.dot(b)) * degrees_of_radian;
}

bool is_rotation(const cv::Matx33d& matrix) {
    constexpr double rounding = 0.01;
    return cv::norm(matrix * matrix.t() - cv::Matx33d::eye()) < rounding && cv::determinant(matrix) > 0;
}

std::string degrees_text(double degrees) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g degrees", degrees);
    return text;
}

}  // namespace disparityd::calibration
