// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_picture.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace disparityd::eval {
namespace {

/// A view from above: the camera is in the middle of the lower edge, ahead is up.
class Plan {
public:
    Plan(int side, double most_m) : image(side, side, CV_8UC3, cv::Scalar(40, 40, 40)), scale_((side - 20) / most_m) {}

    cv::Point at(double bearing_deg, double metres) const {
        const double angle = bearing_deg * std::numbers::pi / 180;
        return {static_cast<int>(image.cols / 2.0 - metres * scale_ * std::sin(angle)),
                static_cast<int>(image.rows - 10 - metres * scale_ * std::cos(angle))};
    }

    void wedge(const ScanSector& sector, double near, double far, const cv::Scalar& colour) {
        const double from = sector.from_cdeg / 100.0;
        const double to = sector.to_cdeg / 100.0;
        const std::vector<cv::Point> corners{at(from, near), at(from, far), at(to, far), at(to, near)};
        cv::fillConvexPoly(image, corners, colour);
    }

    void ring(double metres) { cv::circle(image, at(0, 0), static_cast<int>(metres * scale_), cv::Scalar(90, 90, 90)); }

    cv::Mat image;

private:
    double scale_;
};

}  // namespace

cv::Mat scan_picture(const Scan& scan, const CourseView& view, const Course& course, const CourseCamera& camera,
                     double low_m, double high_m, double most_m) {
    Plan plan(camera.height, most_m);
    for (const ScanSector& sector : scan.sectors) {
        plan.wedge(sector, 0, std::min(sector.free_mm / 1000.0, most_m), cv::Scalar(70, 130, 70));
    }
    for (double metres = 2; metres <= most_m; metres += 2) {
        plan.ring(metres);
    }
    for (std::size_t i = 0; i < view.object.size(); ++i) {
        const Point p = view.point[i];
        const double height = p.z - course.slope_ahead * p.x - course.slope_left * p.y;
        if (view.object[i] >= -2 && view.object[i] != -1 && height >= low_m && height < high_m) {
            const cv::Point at = plan.at(std::atan2(p.y, p.x) * 180 / std::numbers::pi, std::hypot(p.x, p.y));
            if (at.inside({0, 0, plan.image.cols, plan.image.rows})) {
                plan.image.at<cv::Vec3b>(at) = {255, 160, 60};
            }
        }
    }
    for (const ScanSector& sector : scan.sectors) {
        if (sector.state == SectorState::occupied) {
            const double distance = sector.distance_mm / 1000.0;
            plan.wedge(sector, distance, distance + most_m / 100, cv::Scalar(40, 40, 255));
        }
    }
    const cv::Mat grey(camera.height, camera.width, CV_8UC1, const_cast<std::uint8_t*>(view.left.data()));
    cv::Mat left;
    cv::cvtColor(grey, left, cv::COLOR_GRAY2BGR);
    cv::Mat both;
    cv::hconcat(left, plan.image, both);
    return both;
}

}  // namespace disparityd::eval
