// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/raw_messages.h"

#include <algorithm>

#include "bridges/frames/planes.h"
#include "bridges/ros_messages/image_messages.h"

namespace disparityd::ros {
namespace {

constexpr int rotation_numbers = 9;

}  // namespace

std::optional<RawCalibration> raw_calibration(const v1::Status& status) {
    if (!status.has_raw_cameras()) {
        return std::nullopt;
    }
    return RawCalibration{status.geometry().calibration_id(), status.raw_cameras()};
}

std::optional<std::array<double, 9>> left_turn(const RawCalibration& raw) {
    std::optional<std::array<double, 9>> turn;
    const auto& numbers = raw.cameras.left().rotation();
    if (numbers.size() == rotation_numbers) {
        std::copy(numbers.begin(), numbers.end(), turn.emplace().begin());
    }
    return turn;
}

std::optional<std::string> raw_image(const disparity::Frame& frame, Camera camera, const FrameNames& names) {
    const auto product = camera == Camera::left ? disparity::Product::raw_left : disparity::Product::raw_right;
    const disparity::PlaneData* plane = frames::whole_plane(frame, product);
    if (plane == nullptr) {
        return std::nullopt;
    }
    return rows_image({.width = plane->width,
                       .height = plane->height,
                       .encoding = "mono8",
                       .data = plane->bytes.data(),
                       .stride = plane->width},
                      frame.realtime_ns, names.raw);
}

std::optional<std::string> raw_camera_info(const disparity::Frame& frame, const RawCalibration& raw, Camera camera,
                                           const FrameNames& names) {
    const v1::RawCamera& eye = camera == Camera::right ? raw.cameras.right() : raw.cameras.left();
    if (frame.calibration_id != raw.calibration_id || frame.f <= 0 || frame.baseline_mm <= 0 ||
        eye.rotation_size() != rotation_numbers) {
        return std::nullopt;
    }
    CameraInfoFields fields{.realtime_ns = frame.realtime_ns,
                            .frame = names.raw,
                            .width = raw.cameras.width(),
                            .height = raw.cameras.height(),
                            .d = {eye.distortion().begin(), eye.distortion().end()},
                            .k = {eye.fx(), 0, eye.cx(), 0, eye.fy(), eye.cy(), 0, 0, 1},
                            .p = projection(frame, camera)};
    fields.model = distortion_model(eye.lens() == "fisheye", fields.d.size());
    std::copy(eye.rotation().begin(), eye.rotation().end(), fields.r.begin());
    return camera_info_message(fields);
}

}  // namespace disparityd::ros
