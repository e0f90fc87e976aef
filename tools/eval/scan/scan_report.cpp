// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "obstacles/scan.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/scan/course.h"
#include "tools/eval/scan/course_scanner.h"
#include "tools/eval/scan/percent_text.h"
#include "tools/eval/scan/scan_judgement.h"
#include "tools/eval/seed_argument.h"
#include "tools/images/image_file.h"

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

/// Returns the left image beside the scan from above, BGR: what is free is green, obstacles are red, points of the
/// truth within the band are blue; a grey ring each 2 m up to `most_m`.
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
    cv::Mat left;
    cv::cvtColor(image_of(view.left, camera), left, cv::COLOR_GRAY2BGR);
    cv::Mat both;
    cv::hconcat(left, plan.image, both);
    return both;
}

/// Scans courses of one camera.
class CourseRunner {
public:
    CourseRunner(const ScanEvaluation& evaluation, const CourseCamera& camera, Parallel& workers)
        : evaluation_(evaluation), camera_(camera), scanner_(evaluation.settings, camera, workers) {}

    ScanCounts run(const Course& course) {
        const CourseView view = draw(course, camera_);
        const ScanOptions& options = evaluation_.settings.scan;
        const Scan& scan = scanner_.scan(image_of(view.left, camera_), image_of(view.right, camera_), course.sequel);
        if (!evaluation_.pictures.empty()) {
            std::string file = course.name + ".png";
            std::replace(file.begin(), file.end(), ' ', '-');
            images::write_png(evaluation_.pictures + '/' + file,
                              scan_picture(scan, view, course, camera_, options.low_m, options.high_m, course.wall_m));
        }
        return judge(scan, options, view, course, camera_, evaluation_.settings.match.range.count);
    }

private:
    const ScanEvaluation& evaluation_;
    CourseCamera camera_;
    CourseScanner scanner_;
};

std::vector<std::string> line(const std::string& name, const ScanCounts& counts) {
    return {name,
            std::to_string(counts.sectors),
            std::to_string(counts.obstacles),
            std::to_string(counts.missed),
            std::to_string(counts.declared_free),
            std::to_string(counts.near),
            std::to_string(counts.near_free),
            std::to_string(counts.false_alarms),
            percent(counts.unknown, counts.sectors, 1),
            percent(counts.free_share, counts.sectors, 1),
            percent_at(counts.errors, 0.5),
            percent_at(counts.errors, 0.95)};
}

}  // namespace

std::optional<std::uint32_t> seed_of_courses(const std::vector<std::string>& data) {
    return seed_argument("--scan", "courses", data);
}

std::optional<std::uint32_t> seed_of_conditions(const std::vector<std::string>& data) {
    return seed_argument("--scan", "conditions", data);
}

void report_scans(const ScanEvaluation& evaluation, Parallel& workers, bool markdown) {
    const std::vector<Course> courses = make_courses(evaluation.seed, evaluation.courses_per_kind);
    tools::Table table({"course", "sectors", "obstacles", "missed", "of them said free", "too near",
                        "of them said free", "false alarms", "unknown %", "free share %", "error % p50", "p95"});
    ScanCounts of_kind;
    ScanCounts all;
    CourseRunner runner(evaluation, {}, workers);
    {
        tools::Progress progress("courses", courses.size());
        for (std::size_t i = 0; i < courses.size(); ++i) {
            progress.show(i, courses[i].name);
            of_kind.add(runner.run(courses[i]));
            if (i + 1 == courses.size() || courses[i + 1].kind != courses[i].kind) {
                table.add(line(courses[i].kind, of_kind));
                all.add(of_kind);
                of_kind = {};
            }
        }
    }
    table.add(line("all", all));
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

}  // namespace disparityd::eval
