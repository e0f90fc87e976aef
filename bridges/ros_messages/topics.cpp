// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/topics.h"

#include <algorithm>
#include <array>

#include "base/words.h"

namespace disparityd::ros {
namespace {

/// The names below the namespace; "": that table has none.
struct Names {
    Content content;
    std::string_view image_pipeline;
    std::string_view zed;
};

constexpr std::array names{
    Names{Content::left_info, "left/camera_info", "left/color/rect/camera_info"},
    Names{Content::left_info, "", "left/gray/rect/camera_info"},
    Names{Content::left_info, "depth/camera_info", "depth/camera_info"},
    Names{Content::right_info, "right/camera_info", "right/color/rect/camera_info"},
    Names{Content::right_info, "", "right/gray/rect/camera_info"},
    Names{Content::left_grey_image, "left/image_rect", "left/gray/rect/image"},
    Names{Content::right_grey_image, "right/image_rect", "right/gray/rect/image"},
    Names{Content::left_image, "left/image_rect_color", "left/color/rect/image"},
    Names{Content::right_image, "right/image_rect_color", "right/color/rect/image"},
    Names{Content::raw_left_image, "raw/left/image_raw", "left/gray/raw/image"},
    Names{Content::raw_right_image, "raw/right/image_raw", "right/gray/raw/image"},
    Names{Content::raw_left_info, "raw/left/camera_info", "left/gray/raw/camera_info"},
    Names{Content::raw_right_info, "raw/right/camera_info", "right/gray/raw/camera_info"},
    Names{Content::left_jpeg, "left/image_rect_color/compressed", "left/color/rect/image/compressed"},
    Names{Content::depth, "depth/image_rect", "depth/depth_registered"},
    Names{Content::depth_mm, "depth/image_rect_raw", "depth/depth_registered_mm"},
    Names{Content::compressed_depth, "depth/image_rect_raw/compressedDepth",
          "depth/depth_registered_mm/compressedDepth"},
    Names{Content::compressed_depth, "", "depth/depth_registered/compressedDepth"},  // where others look for it
    Names{Content::depth_error, "depth/error", "depth/error"},
    Names{Content::disparity, "disparity", "disparity/map"},
    Names{Content::confidence, "confidence", "confidence/confidence_image"},
    Names{Content::points, "points2", "point_cloud/cloud_registered"},
    Names{Content::scan, "scan", "scan"},
    Names{Content::imu, "imu/data_raw", "imu/data_raw"},
    Names{Content::imu, "", "imu/data"},  // elsewhere it is one with an orientation (REP-145)
    Names{Content::magnetic_field, "imu/mag", "imu/mag"},
    Names{Content::imu_temperature, "temperature/imu", "temperature/imu"},
    Names{Content::camera_temperature, "temperature/camera", "temperature/camera"},
    Names{Content::left_temperature, "temperature/left", "temperature/left"},
    Names{Content::right_temperature, "temperature/right", "temperature/right"},
    Names{Content::pressure, "atm_press", "atm_press"},
    Names{Content::humidity, "humidity", "humidity"},
};

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool is_letter_or_digit(char c) {
    return is_letter(c) || (c >= '0' && c <= '9');
}

}  // namespace

bool is_ros_name(std::string_view name) {
    return !name.empty() && is_letter(name.front()) && std::all_of(name.begin(), name.end(), is_letter_or_digit) &&
           name.find("__") == std::string_view::npos;
}

bool is_ros_namespace(std::string_view name) {
    if (!name.empty() && name.front() == '/') {
        name.remove_prefix(1);
    }
    const std::vector<std::string_view> parts = base::split(name, '/');
    return name.empty() || std::all_of(parts.begin(), parts.end(), is_ros_name);
}

bool is_frame_name(std::string_view name) {
    return !name.empty() && name.front() != '/' && name.back() != '/' &&
           std::all_of(name.begin(), name.end(),
                       [](char c) { return is_letter_or_digit(c) || c == '-' || c == '.' || c == '/'; });
}

std::string default_namespace(Naming naming, const std::string& camera_name) {
    return "/" + camera_name + (naming == Naming::zed ? "/zed_node" : "");
}

std::vector<Topic> all_topics(Naming naming, const std::string& name_space, bool clock) {
    std::string prefix = name_space == "/" ? "" : name_space;
    if (!prefix.empty() && prefix.front() != '/') {
        prefix.insert(0, "/");
    }
    std::vector<Topic> topics;
    for (const Names& row : names) {
        const std::string_view name = naming == Naming::zed ? row.zed : row.image_pipeline;
        if (!name.empty()) {
            topics.push_back({row.content, prefix + "/" + std::string(name)});
        }
    }
    topics.push_back({Content::diagnostics, "/diagnostics"});
    if (clock) {
        topics.push_back({Content::clock, "/clock"});
    }
    return topics;
}

FrameNames frame_names(Naming naming, const std::string& camera_name) {
    if (naming == Naming::zed) {
        return {.left = camera_name + "_left_camera_frame_optical",
                .raw = camera_name + "_left_camera_raw_frame_optical",
                .camera = camera_name + "_left_camera_frame",
                .scan = camera_name + "_footprint",
                .imu = camera_name + "_imu_link"};
    }
    return {.left = camera_name + "_left_optical_frame",
            .raw = camera_name + "_left_raw_optical_frame",
            .camera = camera_name + "_link",
            .scan = camera_name + "_footprint",
            .imu = camera_name + "_imu_link"};
}

std::string right_frame_name(Naming naming, const std::string& camera_name) {
    return camera_name + (naming == Naming::zed ? "_right_camera_frame_optical" : "_right_optical_frame");
}

}  // namespace disparityd::ros
