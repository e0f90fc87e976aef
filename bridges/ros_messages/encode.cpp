// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/encode.h"

#include <array>
#include <stdexcept>

#include "bridges/ros_messages/camera_info_message.h"
#include "bridges/ros_messages/image_messages.h"
#include "bridges/ros_messages/message_header.h"
#include "bridges/ros_messages/sensor_messages.h"
#include "bridges/ros_messages/transform_message.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::SensorSample;

/// Turns the camera's axes (z up) into the optical ones (z ahead), so that a viewer shows points upright.
std::string optical_transform(const Frame& frame, const FrameNames& names) {
    const std::array transforms{Transform{names.camera, names.left, {}, optical_to_robot}};
    return transform_message(frame.realtime_ns, transforms);
}

std::optional<std::string> scan_message(const Frame& frame, const Encoding& encoding) {
    try {
        const std::optional<disparity::Scan> scan = frame.scan();
        return scan ? laser_scan(*scan, frame.realtime_ns, encoding.names, encoding.hidden) : std::nullopt;
    } catch (const std::runtime_error&) {  // a scan of another version, from a newer daemon
        return std::nullopt;
    }
}

std::optional<std::string> raw_info(const Frame& frame, Camera camera, const Encoding& encoding) {
    return encoding.raw ? raw_camera_info(frame, *encoding.raw, camera, encoding.names) : std::nullopt;
}

/// rosgraph_msgs/msg/Clock
std::string clock_message(const Frame& frame) {
    CdrWriter cdr(8);
    write_time(cdr, frame.realtime_ns);
    return cdr.take();
}

}  // namespace

std::optional<std::string> encode(Content content, const Frame& frame, const Encoding& encoding) {
    const FrameNames& names = encoding.names;
    switch (content) {
        case Content::left_image: return left_image(frame, names);
        case Content::right_image: return right_image(frame, names);
        case Content::left_grey_image: return left_grey_image(frame, names);
        case Content::right_grey_image: return right_grey_image(frame, names);
        case Content::left_jpeg: return left_jpeg(frame, encoding.jpeg_quality, names);
        case Content::left_info: return camera_info(frame, Camera::left, names);
        case Content::right_info: return camera_info(frame, Camera::right, names);
        case Content::disparity: return disparity_image(frame, names);
        case Content::depth: return depth_image(frame, names);
        case Content::depth_mm: return depth_mm_image(frame, names);
        case Content::compressed_depth: return compressed_depth(frame, encoding.depth_codec, names);
        case Content::depth_error: return depth_error_image(frame, names);
        case Content::confidence: return confidence_image(frame, names);
        case Content::points: return point_cloud(frame, encoding.cloud, names);
        case Content::scan: return scan_message(frame, encoding);
        case Content::raw_left_image: return raw_image(frame, Camera::left, names);
        case Content::raw_right_image: return raw_image(frame, Camera::right, names);
        case Content::raw_left_info: return raw_info(frame, Camera::left, encoding);
        case Content::raw_right_info: return raw_info(frame, Camera::right, encoding);
        case Content::transforms: return optical_transform(frame, names);
        case Content::clock: return clock_message(frame);
        default: return std::nullopt;
    }
}

std::optional<std::string> encode(Content content, const SensorSample& sample, const FrameNames& names) {
    switch (content) {
        case Content::imu: return imu(sample, names);
        case Content::magnetic_field: return magnetic_field(sample, names);
        case Content::imu_temperature: return imu_temperature(sample, names);
        case Content::camera_temperature: return camera_temperature(sample, names);
        case Content::left_temperature: return left_temperature(sample, names);
        case Content::right_temperature: return right_temperature(sample, names);
        case Content::pressure: return pressure(sample, names);
        case Content::humidity: return humidity(sample, names);
        default: return std::nullopt;
    }
}

std::string_view message_name(Content content) {
    switch (content) {
        case Content::left_image:
        case Content::right_image:
        case Content::left_grey_image:
        case Content::right_grey_image:
        case Content::depth:
        case Content::depth_mm:
        case Content::depth_error:
        case Content::raw_left_image:
        case Content::raw_right_image:
        case Content::confidence: return "sensor_msgs/Image";
        case Content::left_jpeg:
        case Content::compressed_depth: return "sensor_msgs/CompressedImage";
        case Content::left_info:
        case Content::right_info:
        case Content::raw_left_info:
        case Content::raw_right_info: return "sensor_msgs/CameraInfo";
        case Content::disparity: return "stereo_msgs/DisparityImage";
        case Content::points: return "sensor_msgs/PointCloud2";
        case Content::scan: return "sensor_msgs/LaserScan";
        case Content::transforms: return "tf2_msgs/TFMessage";
        case Content::imu: return "sensor_msgs/Imu";
        case Content::magnetic_field: return "sensor_msgs/MagneticField";
        case Content::imu_temperature:
        case Content::camera_temperature:
        case Content::left_temperature:
        case Content::right_temperature: return "sensor_msgs/Temperature";
        case Content::pressure: return "sensor_msgs/FluidPressure";
        case Content::humidity: return "sensor_msgs/RelativeHumidity";
        case Content::diagnostics: return "diagnostic_msgs/DiagnosticArray";
        case Content::clock: return "rosgraph_msgs/Clock";
        case Content::status: break;
    }
    return {};
}

}  // namespace disparityd::ros
