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

/// Returns the inverse but for a factor, which places in the plane do not have.
std::array<double, 9> adjugate_of(const std::array<double, 9>& m) {
    return {m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
            m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
            m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
}

/// Returns the place that the matrix takes (x, y, 1) to.
ImagePoint taken_by(const std::array<double, 9>& matrix, double x, double y) {
    const auto row = [&](std::size_t i) { return matrix[i] * x + matrix[i + 1] * y + matrix[i + 2]; };
    return {row(0) / row(6), row(3) / row(6)};
}

}  // namespace

Lens::Lens(const CameraModel& camera) : camera_(camera) {
    const auto& k = camera.distortion;
    tilted_ = camera.lens == LensModel::pinhole && (k[12] != 0 || k[13] != 0);
    if (tilted_) {
        tilt_ = tilt_of(k[12], k[13]);
        untilt_ = adjugate_of(tilt_);
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

ImagePoint Lens::ray_of(ImagePoint pixel) const {
    constexpr int steps = 5;
    const ImagePoint plain{(pixel.x - camera_.cx) / camera_.fx, (pixel.y - camera_.cy) / camera_.fy};
    const ImagePoint seen = tilted_ ? taken_by(untilt_, plain.x, plain.y) : plain;
    ImagePoint ray = seen;
    for (int step = 0; step < steps; ++step) {
        const double scale = radial(ray.x, ray.y);
        if (scale < 0) {
            return plain;  // beyond what the lens can show
        }
        const ImagePoint shift = shifted({0, 0}, ray.x, ray.y);
        ray = {(seen.x - shift.x) / scale, (seen.y - shift.y) / scale};
    }
    return ray;
}

double Lens::radial(double x, double y) const {
    const auto& k = camera_.distortion;
    const double r2 = x * x + y * y;
    return (1 + ((k[4] * r2 + k[1]) * r2 + k[0]) * r2) / (1 + ((k[7] * r2 + k[6]) * r2 + k[5]) * r2);
}

ImagePoint Lens::shifted(ImagePoint place, double x, double y) const {
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y] = camera_.distortion;
    const double x2 = x * x;
    const double y2 = y * y;
    const double r2 = x2 + y2;
    const double xy = 2 * x * y;
    return {place.x + p1 * xy + p2 * (r2 + 2 * x2) + s1 * r2 + s2 * r2 * r2,
            place.y + p1 * (r2 + 2 * y2) + p2 * xy + s3 * r2 + s4 * r2 * r2};
}

ImagePoint Lens::pinhole(double x, double y) const {
    const double scale = radial(x, y);
    const ImagePoint place = shifted({x * scale, y * scale}, x, y);
    return tilted_ ? taken_by(tilt_, place.x, place.y) : place;
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
