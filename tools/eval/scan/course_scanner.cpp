// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/course_scanner.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "kernels/noise/noise_level.h"
#include "tools/eval/frame_buffers.h"

namespace disparityd::eval {
namespace {

scan::Camera scan_camera(const CourseCamera& camera) {
    const double k = 16 * camera.f * 1000 * camera.baseline_m;
    return {camera.width,       camera.height, camera.f, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0,
            {std::lround(k), 0}};
}

double share_of_known(const FrameView& frame) {
    std::ptrdiff_t known = 0;
    for (int y = 0; y < frame.confidence.height; ++y) {
        const auto* row = frame.confidence.row(y);
        known += frame.confidence.width - std::count(row, row + frame.confidence.width, std::uint8_t{0});
    }
    return static_cast<double>(known) / (static_cast<double>(frame.confidence.width) * frame.confidence.height);
}

}  // namespace

CourseScanner::CourseScanner(const ScanSettings& settings, const CourseCamera& camera, Parallel& workers)
    : settings_(settings),
      camera_(camera),
      workers_(workers),
      matcher_(settings.backend->create({camera.width, camera.height, settings.match})) {}

const Scan& CourseScanner::scan(const cv::Mat& left, const cv::Mat& right, bool sequel) {
    FrameBuffers frame(*matcher_, left, right, workers_);
    if (adapts_to_noise(settings_.match)) {
        frame.settle_noise_level(workers_);
    } else {
        frame.match(workers_);
    }
    if (!sequel) {
        scanner_.emplace(camera_.width, camera_.height, settings_.scan, fastest_frame_steps());
    }
    scan_ = scanner_->empty_scan();
    scanner_->scan({frame.view().disparity, frame.view().confidence}, scan_camera(camera_), scan_, std::nullopt,
                   frame.near());
    density_ = share_of_known(frame.view());
    return scan_;
}

cv::Mat image_of(const std::vector<std::uint8_t>& pixels, const CourseCamera& camera) {
    return {camera.height, camera.width, CV_8UC1, const_cast<std::uint8_t*>(pixels.data())};
}

}  // namespace disparityd::eval
