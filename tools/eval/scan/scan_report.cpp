// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include "kernels/scan/obstacle_scanner.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/scan/course.h"
#include "tools/eval/scan/scan_judgement.h"
#include "tools/eval/scan/scan_picture.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

scan::Camera scan_camera(const CourseCamera& camera) {
    const double k = 16 * camera.f * 1000 * camera.baseline_m;
    return {camera.width,       camera.height, camera.f, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0,
            {std::lround(k), 0}};
}

/// Matches and scans courses of one camera.
class CourseRunner {
public:
    CourseRunner(const ScanEvaluation& evaluation, const CourseCamera& camera, Parallel& workers)
        : evaluation_(evaluation),
          camera_(camera),
          workers_(workers),
          matcher_(evaluation.backend->create({camera.width, camera.height, evaluation.match})) {}

    ScanCounts run(const Course& course) {
        const CourseView view = draw(course, camera_);
        const auto image = [&](const std::vector<std::uint8_t>& pixels) {
            return cv::Mat(camera_.height, camera_.width, CV_8UC1, const_cast<std::uint8_t*>(pixels.data()));
        };
        FrameBuffers frame(*matcher_, image(view.left), image(view.right), workers_);
        frame.match(workers_);
        // A scanner of its own: a course is no sequel of the one before.
        ObstacleScanner scanner(camera_.width, camera_.height, evaluation_.scan, fastest_frame_steps());
        Scan scan = scanner.empty_scan();
        scanner.scan({frame.view().disparity, frame.view().confidence}, scan_camera(camera_), scan);
        if (!evaluation_.pictures.empty()) {
            std::string file = course.name + ".png";
            std::replace(file.begin(), file.end(), ' ', '-');
            images::write_png(evaluation_.pictures + '/' + file,
                              scan_picture(scan, view, course, camera_, evaluation_.scan.low_m, evaluation_.scan.high_m,
                                           course.wall_m));
        }
        return judge(scan, evaluation_.scan, view, course, camera_, evaluation_.match.range.count);
    }

private:
    const ScanEvaluation& evaluation_;
    CourseCamera camera_;
    Parallel& workers_;
    std::unique_ptr<Matcher> matcher_;
};

std::string percent(double part, double whole, int decimals) {
    return whole > 0 ? tools::fixed(100 * part / whole, decimals) : "-";
}

double at_share(std::vector<double> values, double share) {
    if (values.empty()) {
        return NAN;
    }
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

std::vector<std::string> line(const std::string& name, const ScanCounts& counts) {
    const auto error = [&](double share) {
        return counts.errors.empty() ? "-" : tools::fixed(100 * at_share(counts.errors, share), 1);
    };
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
            error(0.5),
            error(0.95)};
}

}  // namespace

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
