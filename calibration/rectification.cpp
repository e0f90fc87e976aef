// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectification.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "base/message_text.h"
#include "calibration/calibration.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {
namespace {

constexpr double smallest_factor = 0.25;
constexpr double smallest_share = 0.25;
constexpr int steps = 24;  // of the grid that is laid over the rectified image, each way

std::string short_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", number);
    return text;
}

/// What the rectified camera has, for the size of the raw eyes.
struct View {
    cv::Mat turn[2];
    double f = 0;
    double cx = 0;
    double cy = 0;
};

cv::Matx33d matrix_of(const CameraModel& camera) {
    return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

View view_of(const StereoCalibration& calibration) {
    View view;
    cv::Mat projection[2], to_depth;
    cv::stereoRectify(matrix_of(calibration.left), calibration.left.distortion, matrix_of(calibration.right),
                      calibration.right.distortion, {calibration.width, calibration.height},
                      cv::Matx33d(calibration.rotation.data()), cv::Vec3d(calibration.translation.data()), view.turn[0],
                      view.turn[1], projection[0], projection[1], to_depth, cv::CALIB_ZERO_DISPARITY, 0);
    view.f = projection[0].at<double>(0, 0);
    view.cx = projection[0].at<double>(0, 2);
    view.cy = projection[0].at<double>(1, 2);
    return view;
}

/// Returns where the grid's points lie in the raw image; nothing when some lie behind the camera.
std::vector<cv::Point2d> grid_in_raw_image(const StereoCalibration& calibration, const CameraModel& camera,
                                           const View& view, const cv::Mat& turn) {
    const cv::Matx33d back = cv::Matx33d(turn).t();
    std::vector<cv::Point3d> rays;
    for (int y = 0; y <= steps; ++y) {
        for (int x = 0; x <= steps; ++x) {
            const cv::Vec3d ray = back * cv::Vec3d((calibration.width * x / double{steps} - view.cx) / view.f,
                                                   (calibration.height * y / double{steps} - view.cy) / view.f, 1);
            if (!(ray[2] > 0)) {
                return {};
            }
            rays.emplace_back(ray);
        }
    }
    std::vector<cv::Point2d> points;
    cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), camera.distortion, points);
    return points;
}

/// The area of the grid in the raw image; negative when a cell of it is turned over.
double area_of(const std::vector<cv::Point2d>& points) {
    double sum = 0;
    for (int y = 0; y < steps; ++y) {
        for (int x = 0; x < steps; ++x) {
            const auto at = [&](int right, int down) {
                return points[static_cast<std::size_t>((y + down) * (steps + 1) + x + right)];
            };
            const double area = 0.5 * (at(1, 1) - at(0, 0)).cross(at(0, 1) - at(1, 0));
            if (!(area > 0)) {
                return -1;
            }
            sum += area;
        }
    }
    return sum;
}

/// Checks that two raw eyes can be rectified to a camera that is like them: its focal length is within a quarter and
/// four times theirs, it shows at least a quarter of each eye's image, and the lenses do not fold what it shows.
/// Numbers may each be possible and together be those of no camera. Throws std::invalid_argument with one line.
void check_rectified_view(const StereoCalibration& calibration) {
    const View view = view_of(calibration);
    const std::string advice =
        ": these numbers are not those of a stereo camera with images of this size; compare the size that the "
        "calibration was made for, "
        "or calibrate again";
    for (const CameraModel* camera : {&calibration.left, &calibration.right}) {
        const double factor = view.f / camera->fx;
        if (!(factor >= smallest_factor && factor <= 1 / smallest_factor)) {
            refuse_calibration(calibration.origin, "cannot be rectified: the focal length becomes " +
                                                       short_text(view.f) + " px, that of the eyes is " +
                                                       short_text(camera->fx) +
                                                       " px, allowed is a quarter to four times of it" + advice);
        }
    }
    for (const int eye : {0, 1}) {
        const CameraModel& camera = eye == 0 ? calibration.left : calibration.right;
        const auto points = grid_in_raw_image(calibration, camera, view, view.turn[eye]);
        const double area = points.empty() ? -1 : area_of(points);
        const double share = area / (static_cast<double>(calibration.width) * calibration.height);
        const std::string name = eye == 0 ? "left" : "right";
        if (area < 0) {
            refuse_calibration(calibration.origin,
                               "cannot be rectified: the distortion folds the image of the " + name + " eye" + advice);
        }
        if (!(share >= smallest_share)) {
            refuse_calibration(calibration.origin, "cannot be rectified: the rectified image shows " +
                                                       short_text(100 * share) + " % of that of the " + name +
                                                       " eye, allowed is at least 25 %" + advice);
        }
    }
}

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
