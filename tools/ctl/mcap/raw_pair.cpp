// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/raw_pair.h"

#include <utility>

#include "bridges/ros_messages/image_messages.h"
#include "calibration/lens.h"
#include "calibration/rectified_camera.h"
#include "pipeline/rectification_schedule.h"

namespace disparityd::tools {
namespace {

using calibration::CameraModel;
using calibration::LensModel;
using calibration::StereoCalibration;

constexpr std::string_view image_type = "sensor_msgs/Image";
constexpr std::string_view info_type = "sensor_msgs/CameraInfo";

/// How ROS calls the pixels of a format.
std::string_view encoding_of(PixelFormat format) {
    switch (format) {
        case PixelFormat::grey8: return "mono8";
        case PixelFormat::yuyv: return "yuv422_yuy2";
        case PixelFormat::bgr24: return "bgr8";
    }
    return {};
}

/// Fills in the lens: of Brown's model as few coefficients as do, as programs may know no more.
void put_lens(ros::CameraInfoFields& fields, const CameraModel& camera) {
    fields.k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
    fields.d = calibration::lens_coefficients(camera);
    fields.model = ros::distortion_model(camera.lens == LensModel::fisheye, fields.d.size());
}

void put_rectified(ros::CameraInfoFields& fields, const CameraModel& camera, double shift) {
    put_lens(fields, camera);
    fields.p = ros::projection(camera.fx, camera.cx, camera.cy, shift);
}

}  // namespace

bool gives_distances(const StereoCalibration& calibration) {
    return calibration.left.fx > 0 && calibration.translation[0] < 0;
}

StereoCalibration calibration_of(const capture::RawFrame& frame, const StereoCalibration& calibration) {
    pipeline::check_recorded_correction(frame);
    if (calibration.rectified || !frame.correction.any()) {
        return calibration;
    }
    return corrected(calibration, frame.correction);
}

RawPair::RawPair(const capture::SourceInfo& source, const std::string& camera)
    : rectified_(source.calibration && source.calibration->rectified) {
    if (source.calibration && gives_distances(*source.calibration)) {
        calibration_ = source.calibration;
    }
    const std::string_view image = !rectified_                           ? "image_raw"
                                   : source.format == PixelFormat::grey8 ? "image_rect"
                                                                         : "image_rect_color";
    for (const auto& [eye, which] : {std::pair(0U, ros::Camera::left), {1U, ros::Camera::right}}) {
        images_[eye] = topic_of_eye(camera, which, image);
        infos_[eye] = topic_of_eye(camera, which, "camera_info");
    }
    const ros::FrameNames names = ros::frame_names(mcap_naming, camera);
    frame_ = rectified_ ? names.left : names.raw;
    if (calibration_) {
        describe(*calibration_);
    }
}

void RawPair::describe(const StereoCalibration& used) {
    Infos infos;
    for (ros::CameraInfoFields& fields : infos) {
        fields.frame = frame_;
        fields.width = static_cast<std::uint32_t>(used.width);
        fields.height = static_cast<std::uint32_t>(used.height);
    }
    constexpr double mm = 1e-3;
    if (rectified_) {
        put_rectified(infos[0], used.left, 0);
        put_rectified(infos[1], used.right, mm * used.translation[0] * used.left.fx);
    } else {
        const calibration::RectifiedCamera view = rectified_camera(used, used.width, used.height);
        put_lens(infos[0], used.left);
        put_lens(infos[1], used.right);
        for (const std::size_t eye : {0U, 1U}) {
            infos[eye].r = view.turn[eye];
            infos[eye].p = ros::projection(view.f, view.cx, view.cy, eye == 0 ? 0 : -mm * view.baseline_mm * view.f);
        }
    }
    fields_ = std::move(infos);
}

std::vector<RosMessageBytes> RawPair::messages_of(const capture::RawFrame& frame) {
    if (calibration_ && frame.correction != correction_) {
        describe(calibration_of(frame, *calibration_));
        correction_ = frame.correction;
    }
    std::vector<RosMessageBytes> messages;
    for (const std::size_t eye : {0U, 1U}) {
        const Plane<const std::uint8_t> rows = frame.image.eye(eye == 0 ? Eye::left : Eye::right);
        const ros::ImageRows image{.width = static_cast<std::uint32_t>(frame.image.eye_width),
                                   .height = static_cast<std::uint32_t>(frame.image.height),
                                   .encoding = encoding_of(frame.image.format),
                                   .bytes_per_pixel = static_cast<std::uint32_t>(bytes_per_pixel(frame.image.format)),
                                   .data = rows.data,
                                   .stride = rows.stride};
        messages.push_back(
            {images_[eye], image_type, frame.realtime_ns, ros::rows_image(image, frame.realtime_ns, frame_)});
        if (fields_) {
            ros::CameraInfoFields fields = (*fields_)[eye];
            fields.realtime_ns = frame.realtime_ns;
            messages.push_back({infos_[eye], info_type, frame.realtime_ns, ros::camera_info_message(fields)});
        }
    }
    return messages;
}

}  // namespace disparityd::tools
