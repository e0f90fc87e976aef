// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectified_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/core/matx.hpp>

#include "calibration/lens.h"
#include "calibration/rotation.h"

namespace disparityd::calibration {

namespace {

/// A place in the rectified image, which OpenCV keeps in single precision: with it all maps stay what they were.
struct Place {
    float x = 0;
    float y = 0;
};

/// Where the pixels of one eye lie for the rectified camera.
class RectifiedEye {
public:
    RectifiedEye(const CameraModel& camera, const std::array<double, 9>& turn) : lens_(camera), turn_(turn) {}

    Place place_of(ImagePoint ray, double f, double cx, double cy) const {
        const double z = turn_[6] * ray.x + turn_[7] * ray.y + turn_[8];
        return {static_cast<float>(f * (turn_[0] * ray.x + turn_[1] * ray.y + turn_[2]) / z + cx),
                static_cast<float>(f * (turn_[3] * ray.x + turn_[4] * ray.y + turn_[5]) / z + cy)};
    }
    ImagePoint ray_of(float x, float y) const { return lens_.ray_of({x, y}); }

private:
    Lens lens_;
    const std::array<double, 9>& turn_;
};

/// Returns where the principal point must be for the corners of the eye's image to have their mean in the middle.
ImagePoint centred(const RectifiedEye& eye, int width, int height, double f) {
    ImagePoint mean;
    for (const int corner : {0, 1, 2, 3}) {
        const ImagePoint exact =
            eye.ray_of(static_cast<float>(corner % 2 * (width - 1)), static_cast<float>(corner / 2 * (height - 1)));
        const ImagePoint ray{static_cast<float>(exact.x), static_cast<float>(exact.y)};
        const Place place = eye.place_of(ray, f, 0, 0);
        mean.x += 0.25 * place.x;
        mean.y += 0.25 * place.y;
    }
    return {0.5 * (width - 1) - mean.x, 0.5 * (height - 1) - mean.y};
}

/// The largest rectangle of the rectified image that the borders of an eye's image leave whole.
struct Inner {
    float left = -std::numeric_limits<float>::max();
    float top = -std::numeric_limits<float>::max();
    float right = std::numeric_limits<float>::max();
    float bottom = std::numeric_limits<float>::max();
};

Inner inner_of(const RectifiedEye& eye, int width, int height, double f, double cx, double cy) {
    constexpr int steps = 8;  // along a border
    Inner inner;
    for (int row = 0; row <= steps; ++row) {
        for (int column = 0; column <= steps; ++column) {
            const auto x = static_cast<float>(column) * static_cast<float>(width) / float{steps};
            const auto y = static_cast<float>(row) * static_cast<float>(height) / float{steps};
            const Place place = eye.place_of(eye.ray_of(x, y), f, cx, cy);
            inner.left = column == 0 ? std::max(inner.left, place.x) : inner.left;
            inner.right = column == steps ? std::min(inner.right, place.x) : inner.right;
            inner.top = row == 0 ? std::max(inner.top, place.y) : inner.top;
            inner.bottom = row == steps ? std::min(inner.bottom, place.y) : inner.bottom;
        }
    }
    // As the width and height of OpenCV's rectangles round it.
    inner.right = inner.left + (inner.right - inner.left);
    inner.bottom = inner.top + (inner.bottom - inner.top);
    return inner;
}

/// Sets f, cx and cy for eyes without a fisheye.
void see_valid_pixels(RectifiedCamera& camera, const StereoCalibration& calibration, int width, int height) {
    const RectifiedEye eyes[] = {{calibration.left, camera.turn[0]}, {calibration.right, camera.turn[1]}};
    const double f =
        (calibration.left.fy + calibration.right.fy) * (static_cast<double>(height) / calibration.height / 2);
    double raw_cx = 0, raw_cy = 0;
    for (const RectifiedEye& eye : eyes) {
        const ImagePoint centre = centred(eye, calibration.width, calibration.height, f);
        raw_cx += 0.5 * centre.x;
        raw_cy += 0.5 * centre.y;
    }
    camera.cx = width * raw_cx / calibration.width;
    camera.cy = height * raw_cy / calibration.height;
    double scale = 0;
    for (const RectifiedEye& eye : eyes) {
        const Inner inner = inner_of(eye, calibration.width, calibration.height, f, raw_cx, raw_cy);
        scale =
            std::max({scale, camera.cx / (raw_cx - inner.left), camera.cy / (raw_cy - inner.top),
                      (width - camera.cx) / (inner.right - raw_cx), (height - camera.cy) / (inner.bottom - raw_cy)});
    }
    camera.f = f * scale;
}

/// Sets f, cx and cy where an eye has a fisheye.
void see_as_fisheye(RectifiedCamera& camera, const StereoCalibration& calibration, int width, int height) {
    const double scale_x = static_cast<double>(width) / calibration.width;
    const double scale_y = static_cast<double>(height) / calibration.height;
    camera.f =
        scale_y * std::min({calibration.left.fx, calibration.left.fy, calibration.right.fx, calibration.right.fy});
    for (const int eye : {0, 1}) {
        const CameraModel& raw = eye == 0 ? calibration.left : calibration.right;
        const auto& turn = camera.turn[eye];
        camera.cx += 0.5 * ((raw.cx + 0.5) * scale_x - 0.5 - camera.f * turn[2] / turn[8]);
        camera.cy += 0.5 * ((raw.cy + 0.5) * scale_y - 0.5 - camera.f * turn[5] / turn[8]);
    }
}

}  // namespace

RectifiedCamera rectified_camera(const StereoCalibration& calibration, int width, int height) {
    RectifiedCamera camera;
    // Each eye is turned by half of what they differ by; then both together until the right one lies along the rows.
    const cv::Matx33d to_right = nearest_rotation(cv::Matx33d(calibration.rotation.data()));
    const cv::Matx33d half = half_rotation(to_right);
    const cv::Vec3d between = half.t() * cv::Vec3d(calibration.translation.data());
    const double distance = std::sqrt(between.dot(between));
    if (!(std::abs(between[0]) > std::abs(between[1]))) {
        return camera;
    }
    const cv::Vec3d along(between[0] > 0 ? 1 : -1, 0, 0);
    const cv::Matx33d to_rows = rotation_between(between * (1 / distance), along);
    const cv::Matx33d turns[] = {to_rows * half, to_rows * half.t()};
    for (const int eye : {0, 1}) {
        std::copy_n(turns[eye].val, 9, camera.turn[eye].begin());
    }
    camera.baseline_mm = -(turns[1] * cv::Vec3d(calibration.translation.data()))[0];
    const bool fisheye = calibration.left.lens == LensModel::fisheye || calibration.right.lens == LensModel::fisheye;
    (fisheye ? see_as_fisheye : see_valid_pixels)(camera, calibration, width, height);
    return camera;
}

}  // namespace disparityd::calibration
