// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/rectified_eyes.h"

#include <cmath>

#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"

namespace disparityd::calibration {

namespace {

/// What an error in a rectified camera may move at the image's side, px.
constexpr double largest_error_px = 0.25;

CameraModel camera_of_projection(const EyeProjection& eye) {
    const auto& p = eye.matrix;
    if (!(p[0] > 0)) {
        refuse_calibration(
            eye.path, eye.key + ": found a focal length of " + base::number_text(p[0]) + ", allowed is more than 0");
    }
    return camera_of_matrix(eye.path, eye.key, {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]});
}

void check_equal(double a, double b, double weight, const std::string& what, const EyeProjection& where,
                 const std::string& advice) {
    if (!(std::abs(a - b) * weight <= largest_error_px)) {
        refuse_calibration(where.path, where.key + ": found " + what + " of " + base::number_text(a) + " and " +
                                           base::number_text(b) + ", which are equal in rectified images: " + advice);
    }
}

}  // namespace

RectifiedEyes rectified_eyes(const EyeProjection& left, const EyeProjection& right, int width, int height,
                             const std::string& advice) {
    RectifiedEyes eyes{camera_of_projection(left), camera_of_projection(right), 0};
    const double f = eyes.left.fx;
    const double side = 0.5 * width / f;  // what a difference of one pixel in f moves at the side of the image
    const double top = 0.5 * height / f;
    check_equal(eyes.left.fx, eyes.right.fx, side, "focal lengths of the two eyes", right, advice);
    check_equal(eyes.left.fy, eyes.right.fy, top, "focal lengths in y of the two eyes", right, advice);
    check_equal(eyes.left.fx, eyes.left.fy, top, "focal lengths in x and y", left,
                "scale the images by the same factor both ways");
    check_equal(eyes.left.cy, eyes.right.cy, 1, "cy of the two eyes", right, advice);
    const auto at = [&](std::size_t i) { return right.matrix[i] / eyes.right.fx - left.matrix[i] / f; };
    eyes.shift = at(3);
    // Small rests of the other directions stay in KITTI's matrices, half a percent of the baseline.
    constexpr double rest = 0.02;
    const double largest_rest = rest * std::abs(eyes.shift);
    if (std::abs(at(7)) > largest_rest || std::abs(right.matrix[11] - left.matrix[11]) > largest_rest) {
        refuse_calibration(right.path, right.key + ": found a translation of " + base::number_text(at(3)) + ", " +
                                           base::number_text(at(7)) + ", " +
                                           base::number_text(right.matrix[11] - left.matrix[11]) +
                                           " between the eyes; allowed are eyes side by side, which differ in x alone");
    }
    return eyes;
}

}  // namespace disparityd::calibration
