// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectification.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <opencv2/calib3d.hpp>

#include "base/message_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/rectified_view.h"

namespace disparityd::calibration {

namespace {

constexpr int largest_side = 8192;

RectifiedGeometry complete(RectifiedGeometry geometry, int eye_width, int height) {
    if (geometry.width == 0 && geometry.height == 0) {
        geometry.width = eye_width;
        geometry.height = height;
    }
    if (geometry.width < 1 || geometry.width > largest_side || geometry.height < 1 || geometry.height > largest_side) {
        throw std::invalid_argument("rectified size: found " + base::size_text(geometry.width, geometry.height) +
                                    ", allowed is 1x1 to 8192x8192, or 0x0 for the capture size");
    }
    RectifiedGeometry::Region& region = geometry.region;
    if (region.width == 0 && region.height == 0 && region.x == 0 && region.y == 0) {
        region.width = geometry.width;
        region.height = geometry.height;
    }
    if (region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1 ||
        region.width > geometry.width - region.x || region.height > geometry.height - region.y) {
        throw std::invalid_argument("rectified region: found " + base::size_text(region.width, region.height) +
                                    " at (" + std::to_string(region.x) + ", " + std::to_string(region.y) +
                                    "), it must lie within the rectified image of " +
                                    base::size_text(geometry.width, geometry.height));
    }
    return geometry;
}

cv::Mat camera_matrix(const CameraModel& camera) {
    return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

Rectification::Maps make_maps(const cv::Mat& camera, const cv::Mat& distortion, const cv::Mat& rotation,
                              const cv::Mat& projection, const RectifiedGeometry& geometry) {
    cv::Mat xy;
    cv::Mat fraction;
    cv::initUndistortRectifyMap(camera, distortion, rotation, projection, {geometry.width, geometry.height}, CV_16SC2,
                                xy, fraction);
    const auto& region = geometry.region;
    const cv::Rect crop(region.x, region.y, region.width, region.height);
    Rectification::Maps maps;
    for (int y = crop.y; y < crop.y + crop.height; ++y) {
        const auto* row = xy.ptr<std::int16_t>(y) + 2 * static_cast<std::ptrdiff_t>(crop.x);
        maps.xy.insert(maps.xy.end(), row, row + 2 * static_cast<std::ptrdiff_t>(crop.width));
        const auto* rest = fraction.ptr<std::uint16_t>(y) + crop.x;
        maps.fraction.insert(maps.fraction.end(), rest, rest + crop.width);
    }
    return maps;
}

void use_projection(Rectification& result, double f, double cx, double cy, const RectifiedGeometry& geometry) {
    result.f = f;
    result.cx = cx - geometry.region.x;
    result.cy = cy - geometry.region.y;
}

// Rectifies two raw eyes by OpenCV: both principal points alike (CALIB_ZERO_DISPARITY), only valid pixels.
void rectify_raw(Rectification& result, const StereoCalibration& calibration, const RectifiedGeometry& geometry) {
    const cv::Mat left = camera_matrix(calibration.left);
    const cv::Mat right = camera_matrix(calibration.right);
    const cv::Mat left_distortion = cv::Mat(calibration.left.distortion, true);
    const cv::Mat right_distortion = cv::Mat(calibration.right.distortion, true);
    const cv::Mat rotation = cv::Mat(calibration.rotation, true).reshape(1, 3);
    const cv::Mat translation = cv::Mat(calibration.translation, true);
    cv::Mat left_turn, right_turn, left_projection, right_projection, to_depth;
    cv::stereoRectify(left, left_distortion, right, right_distortion, {calibration.width, calibration.height}, rotation,
                      translation, left_turn, right_turn, left_projection, right_projection, to_depth,
                      cv::CALIB_ZERO_DISPARITY, 0, {geometry.width, geometry.height});
    const double f = left_projection.at<double>(0, 0);
    const double shift = right_projection.at<double>(0, 3);
    if (!std::isfinite(f) || f <= 0 || !std::isfinite(shift) || shift >= 0) {
        throw std::invalid_argument("calibration " + calibration.origin +
                                    ": cannot be rectified: the cameras do not look side by side the same way");
    }
    check_rectified_view(calibration);
    use_projection(result, f, left_projection.at<double>(0, 2), left_projection.at<double>(1, 2), geometry);
    result.baseline_mm = -shift / f;
    std::copy_n(left_turn.ptr<double>(), 9, result.left_rotation.begin());
    std::copy_n(right_turn.ptr<double>(), 9, result.right_rotation.begin());
    result.left = make_maps(left, left_distortion, left_turn, left_projection, geometry);
    result.right = make_maps(right, right_distortion, right_turn, right_projection, geometry);
}

// Takes eyes as they are, or scales them. Without a focal length only the scale is known.
void scale_rectified(Rectification& result, const StereoCalibration& calibration, const RectifiedGeometry& geometry) {
    const double scale_x = static_cast<double>(geometry.width) / calibration.width;
    const double scale_y = static_cast<double>(geometry.height) / calibration.height;
    const bool metric = calibration.left.fx != 0;
    const auto scaled = [&](const CameraModel& camera) {
        return CameraModel{camera.fx * scale_x,
                           camera.fy * scale_y,
                           (camera.cx + 0.5) * scale_x - 0.5,
                           (camera.cy + 0.5) * scale_y - 0.5,
                           {}};
    };
    if (metric) {
        const CameraModel camera = scaled(calibration.left);
        use_projection(result, camera.fx, camera.cx, camera.cy, geometry);
        result.baseline_mm = -calibration.translation[0];
        result.disparity_offset = (calibration.right.cx - calibration.left.cx) * scale_x;
    }
    if (geometry.width == calibration.width && geometry.height == calibration.height) {
        result.crop_x = geometry.region.x;
        result.crop_y = geometry.region.y;
        return;
    }
    // Both eyes use the same map: a pixel keeps its place in the image, whatever the principal points.
    const CameraModel plain{1, 1, 0, 0, {}};
    const cv::Mat none = cv::Mat::zeros(5, 1, CV_64F);
    result.left =
        make_maps(camera_matrix(plain), none, cv::Mat::eye(3, 3, CV_64F), camera_matrix(scaled(plain)), geometry);
    result.right = result.left;
}

// FNV-1a: short, and the same on every machine.
class Fingerprint {
public:
    template <typename T>
    void add(const std::vector<T>& values) {
        for (const T value : values) {
            add(static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value)));
        }
    }
    void add(double value) { add(static_cast<std::uint64_t>(std::llround(value * 1e6))); }
    void add(int value) { add(static_cast<std::uint64_t>(value)); }
    std::uint64_t value() const { return hash_; }

private:
    void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001b3ULL; }
    std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

std::uint64_t fingerprint(const Rectification& rectification) {
    Fingerprint hash;
    hash.add(rectification.width);
    hash.add(rectification.height);
    hash.add(rectification.crop_x);
    hash.add(rectification.crop_y);
    for (const double value : {rectification.f, rectification.cx, rectification.cy, rectification.baseline_mm,
                               rectification.disparity_offset}) {
        hash.add(value);
    }
    for (const Rectification::Maps* maps : {&rectification.left, &rectification.right}) {
        hash.add(maps->xy);
        hash.add(maps->fraction);
    }
    return hash.value();
}

}  // namespace

Rectification make_rectification(const std::optional<StereoCalibration>& calibration, int eye_width, int height,
                                 const RectifiedGeometry& wanted) {
    if (calibration && (calibration->width != eye_width || calibration->height != height)) {
        refuse_other_size(calibration->origin, base::size_text(calibration->width, calibration->height), eye_width,
                          height);
    }
    const RectifiedGeometry geometry = complete(wanted, eye_width, height);
    Rectification result;
    result.width = geometry.region.width;
    result.height = geometry.region.height;
    result.unrectified = !calibration;
    if (calibration && !calibration->rectified) {
        rectify_raw(result, *calibration, geometry);
    } else {
        StereoCalibration plain;
        plain.width = eye_width;
        plain.height = height;
        scale_rectified(result, calibration.value_or(plain), geometry);
    }
    result.calibration_id = fingerprint(result);
    return result;
}

Rectifier Rectification::rectifier() const {
    Rectifier rectifier;
    rectifier.mapped = !left.xy.empty();
    rectifier.crop_x = crop_x;
    rectifier.crop_y = crop_y;
    rectifier.id = calibration_id;
    const auto view = [this](const Maps& maps) {
        return RectifyMap{{maps.xy.data(), 2 * width, height, 2 * width}, {maps.fraction.data(), width, height, width}};
    };
    if (rectifier.mapped) {
        rectifier.left = view(left);
        rectifier.right = view(right);
    }
    return rectifier;
}

DepthScale Rectification::depth_scale() const {
    return {std::llround(16.0 * f * baseline_mm), static_cast<int>(std::lround(16.0 * disparity_offset))};
}

}  // namespace disparityd::calibration
