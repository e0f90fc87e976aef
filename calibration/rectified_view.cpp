// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectified_view.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

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

}  // namespace

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

}  // namespace disparityd::calibration
