// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/static_transforms.h"

namespace disparityd::ros {

std::string yaw_of_scans_text(const TreeOfFrames& tree) {
    if (tree.parent.empty() || !tree.places_the_scan || tree.place.yaw_deg == 0) {
        return {};
    }
    return tree.names.scan + " has the axes of " + tree.parent +
           ": scans are turned aside unless yaw_deg of the daemon's [scan] is that of --yaw-deg; where it is not, name "
           "their frame by --scan-frame";
}

std::vector<Transform> static_transforms(const TreeOfFrames& tree, double baseline_m,
                                         const std::optional<disparity::InertialPose>& sensor,
                                         const std::optional<std::array<double, 9>>& raw_turn) {
    std::vector<Transform> transforms;
    if (!tree.parent.empty()) {
        const Place& place = tree.place;
        transforms.push_back({tree.parent,
                              tree.names.camera,
                              {place.ahead_m, place.left_m, place.height_m},
                              quaternion_of_degrees(place.roll_deg, place.pitch_deg, place.yaw_deg)});
        if (tree.places_the_scan) {
            transforms.push_back({tree.parent, tree.names.scan, {place.ahead_m, place.left_m, 0}});
        }
    }
    transforms.push_back({tree.names.camera, tree.names.left, {}, optical_to_robot});
    if (baseline_m > 0) {
        transforms.push_back({tree.names.camera, tree.right, {0, -baseline_m, 0}, optical_to_robot});
    }
    if (sensor) {
        const std::array<double, 3>& mm = sensor->translation_mm;
        transforms.push_back({tree.names.left,
                              tree.names.imu,
                              {mm[0] / 1000, mm[1] / 1000, mm[2] / 1000},
                              quaternion(sensor->rotation)});
    }
    if (raw_turn) {
        transforms.push_back({tree.names.left, tree.names.raw, {}, quaternion(*raw_turn)});
    }
    return transforms;
}

}  // namespace disparityd::ros
