// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace disparityd::calibration {

namespace {

/// Returns the series 1 - a (1 - b (1 - ...)), whose factors are square / (n (n + 1)) with n = first, first + 2 ...:
/// that of the cosine begins at 1, that of the sine at 2. Fifteen factors are exact for angles up to 1.6.
double alternating(double square, int first) {
    double sum = 1;
    for (int k = 14; k >= 0; --k) {
        sum = 1 - square / ((2 * k + first) * (2 * k + first + 1)) * sum;
    }
    return sum;
}

double sine(double angle) {
    return angle * alternating(angle * angle, 2);
}

double cosine(double angle) {
    return alternating(angle * angle, 1);
}

/// Returns the arc tangent of a number that is not negative. The angle is halved until a short series does.
double arc_tangent(double tangent) {
    constexpr int halvings = 4;  // a right angle becomes a sixteenth of it, whose tangent is 0.0985
    constexpr int terms = 9;
    for (int i = 0; i < halvings; ++i) {
        tangent /= 1 + std::sqrt(1 + tangent * tangent);
    }
    const double square = tangent * tangent;
    double sum = 0;
    for (int k = terms; k >= 0; --k) {
        sum = 1.0 / (2 * k + 1) - square * sum;
    }
    return tangent * sum * (1 << halvings);
}

/// Returns the matrix that takes a plane before the lens to a tilted sensor, as OpenCV defines it.
std::array<double, 9> tilt_of(double tau_x, double tau_y) {
    const double sx = sine(tau_x), cx = cosine(tau_x), sy = sine(tau_y), cy = cosine(tau_y);
    const std::array<double, 9> turn{cy, sy * sx, -sy * cx, 0, cx, sx, sy, -cy * sx, cy * cx};
    std::array<double, 9> tilt{};
    for (std::size_t column = 0; column < 3; ++column) {
        tilt[column] = turn[8] * turn[column] - turn[2] * turn[6 + column];
        tilt[3 + column] = turn[8] * turn[3 + column] - turn[5] * turn[6 + column];
        tilt[6 + column] = turn[6 + column];
    }
    return tilt;
}

}  // namespace

Lens::Lens(const CameraModel& camera) : camera_(camera) {
    const auto& k = camera.distortion;
    tilted_ = camera.lens == LensModel::pinhole && (k[12] != 0 || k[13] != 0);
    if (tilted_) {
        tilt_ = tilt_of(k[12], k[13]);
    }
}

ImagePoint Lens::pixel_of(double x, double y, double z) const {
    if (!(z > 0)) {
        constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
        return {nowhere, nowhere};
    }
    const ImagePoint place = camera_.lens == LensModel::fisheye ? fisheye(x / z, y / z) : pinhole(x / z, y / z);
    return {camera_.fx * place.x + camera_.cx, camera_.fy * place.y + camera_.cy};
}

ImagePoint Lens::pinhole(double x, double y) const {
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y] = camera_.distortion;
    const double x2 = x * x;
    const double y2 = y * y;
    const double r2 = x2 + y2;
    const double xy = 2 * x * y;
    const double radial = (1 + ((k3 * r2 + k2) * r2 + k1) * r2) / (1 + ((k6 * r2 + k5) * r2 + k4) * r2);
    const double dx = x * radial + p1 * xy + p2 * (r2 + 2 * x2) + s1 * r2 + s2 * r2 * r2;
    const double dy = y * radial + p1 * (r2 + 2 * y2) + p2 * xy + s3 * r2 + s4 * r2 * r2;
    if (!tilted_) {
        return {dx, dy};
    }
    const auto row = [&](std::size_t i) { return tilt_[i] * dx + tilt_[i + 1] * dy + tilt_[i + 2]; };
    return {row(0) / row(6), row(3) / row(6)};
}

ImagePoint Lens::fisheye(double x, double y) const {
    const double r = std::sqrt(x * x + y * y);
    if (r == 0) {
        return {0, 0};
    }
    const auto& k = camera_.distortion;
    const double angle = arc_tangent(r);
    const double a2 = angle * angle;
    const double scale = angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))) / r;
    return {x * scale, y * scale};
}

std::vector<double> lens_coefficients(const CameraModel& camera) {
    std::size_t count = 4;
    if (camera.lens == LensModel::pinhole) {
        const auto& all = camera.distortion;
        const auto used = std::find_if(all.rbegin(), all.rend(), [](double k) { return k != 0; });
        const auto last = static_cast<std::size_t>(all.rend() - used);
        count = last <= 5 ? 5 : last <= 8 ? 8 : last <= 12 ? 12 : 14;
    }
    return {camera.distortion.begin(), camera.distortion.begin() + static_cast<std::ptrdiff_t>(count)};
}

bool set_lens_coefficients(CameraModel& camera, const std::vector<double>& coefficients) {
    const std::size_t count = coefficients.size();
    if (count != 4 && count != 5 && count != 8 && count != 12 && count != 14) {
        return false;
    }
    camera.lens = count == 4 ? LensModel::fisheye : LensModel::pinhole;
    camera.distortion = {};
    std::copy(coefficients.begin(), coefficients.end(), camera.distortion.begin());
    return true;
}

}  // namespace disparityd::calibration
