// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_frames.h"

#include <cmath>
#include <utility>

namespace disparityd::capture {
namespace {

constexpr std::size_t most_frames = 1000;

/// ROS 1 has names with a slash in front, which means nothing.
std::string name_of(std::string_view frame) {
    return std::string(frame.substr(frame.starts_with('/') ? 1 : 0));
}

/// Returns nothing for a quaternion that is no rotation.
std::optional<calibration::Pose> pose_of(const formats::RosMessage& message, const std::string& transform) {
    constexpr double tolerance = 0.01;
    const auto number = [&](const char* field) { return message.number(transform + field); };
    double x = number("rotation.x");
    double y = number("rotation.y");
    double z = number("rotation.z");
    double w = number("rotation.w");
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(std::abs(length - 1) < tolerance)) {
        return std::nullopt;
    }
    for (double* part : {&x, &y, &z, &w}) {
        *part /= length;
    }
    calibration::Pose pose;
    pose.rotation = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                     2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    pose.translation = {1000 * number("translation.x"), 1000 * number("translation.y"), 1000 * number("translation.z")};
    return pose;
}

}  // namespace

void BagFrames::take(const formats::RosMessage& message) {
    for (int i = 0; message.has("transforms." + std::to_string(i) + ".child_frame_id"); ++i) {
        const std::string transform = "transforms." + std::to_string(i) + ".";
        const auto pose = pose_of(message, transform + "transform.");
        if (pose && parents_.size() < most_frames) {
            parents_[name_of(message.text(transform + "child_frame_id"))] = {
                name_of(message.text(transform + "header.frame_id")), *pose};
        }
    }
}

BagFrames::Parent BagFrames::top_of(const std::string& frame) const {
    Parent top{frame, {}};
    // Each step is another frame, unless they go in a circle.
    for (std::size_t step = 0; step < parents_.size(); ++step) {
        const auto above = parents_.find(top.name);
        if (above == parents_.end()) {
            break;
        }
        top = {above->second.name, calibration::chained(top.pose, above->second.pose)};
    }
    return top;
}

std::optional<calibration::Pose> BagFrames::between(const std::string& from, const std::string& to) const {
    const Parent above_from = top_of(name_of(from));
    const Parent above_to = top_of(name_of(to));
    if (name_of(from) == name_of(to)) {
        return std::nullopt;  // two devices are never in the same place: the names were not filled in
    }
    if (above_from.name != above_to.name || parents_.contains(above_from.name)) {
        return std::nullopt;
    }
    return calibration::chained(above_from.pose, calibration::inverse(above_to.pose));
}

}  // namespace disparityd::capture
