// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/data_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/text_file.h"
#include "calibration/calibration.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/rectification.h"
#include "capture/images/image_sequence.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_source.h"
#include "obstacles/obstacle_scanner.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/rendered_scene.h"
#include "tools/eval/scan/percent_text.h"
#include "tools/eval/scan/scan_comparison.h"
#include "tools/eval/scan/true_pixels.h"

namespace disparityd::eval {
namespace {

namespace fs = std::filesystem;

/// Laser points of KITTI lie up to so many px apart.
constexpr int most_gap = 8;
/// An obstacle has to be shown where one sigma is at most this part of its distance.
constexpr double farthest_sigma = 0.1;

scan::Camera camera_of(const calibration::StereoCalibration& calibration, int width, int height) {
    const calibration::Rectification made = calibration::make_rectification(calibration, width, height, {});
    return {width, height, made.f, made.cx, made.cy, made.depth_scale()};
}

/// Returns the calibration that the layout of `folder` has for an image; nothing where it is no such folder.
std::optional<calibration::StereoCalibration> calibration_in(const fs::path& folder, const std::string& image,
                                                             int width, int height) {
    capture::ImageSequence sequence;
    try {
        sequence = capture::find_images(folder.string());
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
    std::string path = sequence.calibration;
    for (const capture::ImageSequence::Frame& frame : sequence.frames) {
        std::error_code error;
        path = path.empty() && fs::equivalent(frame.left, image, error) ? frame.calibration : path;
    }
    if (path.empty()) {
        return std::nullopt;
    }
    if (sequence.kitti_camera < 0) {
        return calibration::read_calibration(path, width, height);
    }
    const auto read = calibration::read_kitti_calibration(path, base::read_text_file(path, "calibration"),
                                                          sequence.kitti_camera, width, height);
    calibration::check_plausible(read, path);
    return read;
}

std::vector<std::string> line(const std::string& name, const ScanComparison& counts) {
    const int judged = counts.sectors - counts.true_unknown;
    return {name,
            std::to_string(judged),
            std::to_string(counts.obstacles),
            std::to_string(counts.missed),
            std::to_string(counts.declared_free),
            std::to_string(counts.false_alarms),
            percent(counts.unknown, judged, 1),
            percent(counts.free_share, judged, 1),
            percent_at(counts.errors, 0.5),
            percent_at(counts.errors, 0.95)};
}

Scan scanned(const scan::Pixels& pixels, const scan::Camera& camera, const ScanOptions& options,
             const scan::NearBlocks& near = {}) {
    ObstacleScanner scanner(camera.width, camera.height, options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    scanner.scan(pixels, camera, scan, std::nullopt, near);
    return scan;
}

ScanComparison judge(const DataEvaluation& evaluation, const SceneToScan& from, Parallel& workers) {
    const Scene scene = from.scene.read();
    const scan::Camera camera = from.camera(scene.left.cols, scene.left.rows);
    if (!camera.metric()) {
        throw std::invalid_argument(from.scene.name + ": the calibration has no baseline, so no distance is known");
    }
    const MatchOptions match = evaluation.match(scene.disparities);
    const auto matcher = evaluation.backend->create({scene.left.cols, scene.left.rows, match});
    FrameBuffers frame(*matcher, scene.left, scene.right, workers);
    frame.match(workers);
    const TruePixels truth(scene.truth, most_gap);
    const double metres = static_cast<double>(camera.scale.k) / 16 / 1000;
    const double farthest =
        std::min(metres * farthest_sigma / evaluation.scan.subpixel_error_px, evaluation.scan.max_m);
    return compare(scanned({frame.view().disparity, frame.view().confidence}, camera, evaluation.scan, frame.near()),
                   scanned(truth.pixels(), camera, evaluation.scan), farthest);
}

}  // namespace

scan::Camera camera_of(const datasets::DatasetScene& files, int width, int height) {
    const fs::path folder = fs::absolute(files.left).parent_path();
    for (const fs::path& root : {folder, folder.parent_path()}) {
        if (const auto calibration = calibration_in(root, files.left, width, height)) {
            return camera_of(*calibration, width, height);
        }
    }
    throw std::invalid_argument(
        "--scan: " + files.left +
        ": found no calibration beside it, allowed: scenes with Middlebury's or KITTI's calib.txt, "
        "calib/NAME.txt, calib_cam_to_cam.txt or calib_cam_to_cam/NAME.txt");
}

scan::Camera camera_of_rendered(int width, int height) {
    return camera_of(capture::scene_calibration(width, height), width, height);
}

std::vector<SceneToScan> scenes_to_scan(const std::vector<std::string>& data, double scale) {
    std::vector<SceneToScan> chosen;
    for (const std::string& one : data) {
        if (capture::is_scene(one)) {
            for (SceneToJudge& scene : rendered_scenes(one)) {
                chosen.push_back({std::move(scene), camera_of_rendered});
            }
            continue;
        }
        for (const datasets::DatasetScene& files : find_scenes({one})) {
            chosen.push_back({scene_of_files(files, 0, scale),
                              [files](int width, int height) { return camera_of(files, width, height); }});
        }
    }
    return chosen;
}

void report_data_scans(const DataEvaluation& evaluation, Parallel& workers, bool markdown) {
    tools::Table table({"scene", "sectors", "obstacles", "missed", "of them said free", "false alarms", "unknown %",
                        "free share %", "error % p50", "p95"});
    ScanComparison all;
    {
        tools::Progress progress("scenes", evaluation.scenes.size());
        for (std::size_t i = 0; i < evaluation.scenes.size(); ++i) {
            progress.show(i, evaluation.scenes[i].scene.name);
            const ScanComparison counts = judge(evaluation, evaluation.scenes[i], workers);
            table.add(line(evaluation.scenes[i].scene.name, counts));
            all.add(counts);
        }
    }
    table.add(line("all", all));
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

}  // namespace disparityd::eval
