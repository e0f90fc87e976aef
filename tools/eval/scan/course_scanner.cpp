// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/course_scanner.h"

#include <cmath>

#include "calibration/empty_result/empty_result.h"
#include "tools/eval/frame_buffers.h"

namespace disparityd::eval {
namespace {

scan::Camera scan_camera(const CourseCamera& camera) {
    const double k = 16 * camera.f * 1000 * camera.baseline_m;
    return {camera.width,       camera.height, camera.f, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0,
            {std::lround(k), 0}};
}

}  // namespace

CourseScanner::CourseScanner(const ScanSettings& settings, const CourseCamera& camera, Parallel& workers)
    : settings_(settings),
      camera_(camera),
      workers_(workers),
      matcher_(settings.backend->create({camera.width, camera.height, settings.match})) {}

const Scan& CourseScanner::scan(const cv::Mat& left, const cv::Mat& right, bool sequel) {
    FrameBuffers frame(*matcher_, left, right, workers_);
    frame.match_alone(workers_);
    if (!sequel) {
        scanner_.emplace(camera_.width, camera_.height, settings_.scan, fastest_frame_steps());
    }
    scan_ = scanner_->empty_scan();
    scanner_->scan({frame.view().disparity, frame.view().confidence}, scan_camera(camera_), scan_, std::nullopt,
                   frame.near());
    density_ = static_cast<double>(empty_result::measured_pixels(frame.view().confidence)) /
               (static_cast<double>(camera_.width) * camera_.height);
    return scan_;
}

cv::Mat image_of(const std::vector<std::uint8_t>& pixels, const CourseCamera& camera) {
    return {camera.height, camera.width, CV_8UC1, const_cast<std::uint8_t*>(pixels.data())};
}

}  // namespace disparityd::eval
