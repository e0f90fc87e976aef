// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "base/number_text.h"
#include "obstacles/obstacle_scanner.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/scan/course.h"
#include "tools/eval/scan/percent_text.h"
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
        if (!course.sequel) {
            scanner_.emplace(camera_.width, camera_.height, evaluation_.scan, fastest_frame_steps());
        }
        Scan scan = scanner_->empty_scan();
        scanner_->scan({frame.view().disparity, frame.view().confidence}, scan_camera(camera_), scan);
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
    std::optional<ObstacleScanner> scanner_;  ///< of this course and its sequels
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
    constexpr std::string_view prefix = "courses:";
    const auto found =
        std::find_if(data.begin(), data.end(), [&](const std::string& one) { return one.starts_with(prefix); });
    if (found == data.end()) {
        return std::nullopt;
    }
    const auto seed = base::parse_number(std::string_view(*found).substr(prefix.size()));
    constexpr double most = 1000000;
    if (!seed || *seed < 0 || *seed > most || *seed != std::floor(*seed) || data.size() > 1) {
        throw std::invalid_argument("--scan: DATA: found '" + *found + "'" + (data.size() > 1 ? " beside others" : "") +
                                    ", allowed: courses:SEED alone, SEED 0 .. 1000000, such as courses:1");
    }
    return static_cast<std::uint32_t>(*seed);
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
