// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/sight.h"

#include <cmath>
#include <cstring>
#include <utility>

namespace disparityd::eval {

CourseCamera camera_at(CourseCamera camera, const Pose& pose) {
    camera.x_m = pose.x;
    camera.y_m = pose.y;
    camera.yaw_deg = degrees(pose.yaw);
    return camera;
}

DriveScanner::DriveScanner(const CourseCamera& camera, DisparityRange range, const ScanOptions& options,
                           std::shared_ptr<StageNotes> notes)
    : camera_(camera),
      stage_(camera.width, camera.height, range, options, nullptr, {}, std::move(notes)),
      record_(stage_.bytes_per_frame()) {}

disparity::Scan DriveScanner::scan(FrameView view, Parallel& workers) {
    view.depth_scale = {std::lround(16 * camera_.f * 1000 * camera_.baseline_m), 0};
    stage_.run({.view = view,
                .memory = record_,
                .f = camera_.f,
                .cx = (camera_.width - 1) / 2.0,
                .cy = (camera_.height - 1) / 2.0,
                .up = {}},
               workers);
    disparity::PlaneData plane;
    plane.product = disparity::Product::scan;
    plane.bytes.resize(record_.size());
    std::memcpy(plane.bytes.data(), record_.data(), record_.size());
    disparity::Frame sent;
    sent.planes.push_back(std::move(plane));
    return sent.scan().value();
}

}  // namespace disparityd::eval
