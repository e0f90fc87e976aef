// SPDX-License-Identifier: Apache-2.0
#include "calibration/rotation.h"

#include <cmath>
#include <limits>

namespace disparityd::calibration {

cv::Matx33d cross_product_matrix(const cv::Vec3d& by) {
    return {0, -by[2], by[1], by[2], 0, -by[0], -by[1], by[0], 0};
}

cv::Matx33d rotation_about(const cv::Vec3d& vector) {
    const double angle = std::sqrt(vector.dot(vector));
    if (angle < std::numeric_limits<double>::epsilon()) {
        return cv::Matx33d::eye();
    }
    const cv::Vec3d axis = vector * (1 / angle);
    const double cosine = std::cos(angle);
    const cv::Matx33d along = axis * axis.t();
    return cv::Matx33d::eye() * cosine + along * (1 - cosine) + cross_product_matrix(axis) * std::sin(angle);
}

cv::Matx33d nearest_rotation(const cv::Matx33d& matrix) {
    // The mean with the transposed inverse halves what lengths along the principal axes differ from 1 by, or better: at
    // the end it squares it.
    constexpr int steps = 40;
    cv::Matx33d turn = matrix;
    for (int step = 0; step < steps; ++step) {
        const cv::Vec3d x(turn(0, 0), turn(0, 1), turn(0, 2));
        const cv::Vec3d y(turn(1, 0), turn(1, 1), turn(1, 2));
        const cv::Vec3d z(turn(2, 0), turn(2, 1), turn(2, 2));
        const cv::Vec3d yz = y.cross(z), zx = z.cross(x), xy = x.cross(y);
        const cv::Matx33d adjugate(yz[0], yz[1], yz[2], zx[0], zx[1], zx[2], xy[0], xy[1], xy[2]);
        turn = (turn + adjugate * (1 / x.dot(yz))) * 0.5;
    }
    return turn;
}

cv::Matx33d half_rotation(const cv::Matx33d& rotation) {
    // The mean with no rotation is shortened across the axis, and turned by half.
    return nearest_rotation(cv::Matx33d::eye() + rotation);
}

cv::Matx33d rotation_between(const cv::Vec3d& from, const cv::Vec3d& to) {
    const cv::Matx33d across = cross_product_matrix(from.cross(to));
    return cv::Matx33d::eye() + across + across * across * (1 / (1 + from.dot(to)));
}

}  // namespace disparityd::calibration
