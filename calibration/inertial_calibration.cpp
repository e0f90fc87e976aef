// SPDX-License-Identifier: Apache-2.0
#include "calibration/inertial_calibration.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/matx.hpp>

#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/pose_agreement.h"

namespace disparityd::calibration {

namespace {

cv::Matx33d turn_of(const Pose& pose) {
    return cv::Matx33d(pose.rotation.data());
}

Pose pose_of(const cv::Matx33d& turn, const cv::Vec3d& shift) {
    Pose pose;
    std::copy(turn.val, turn.val + 9, pose.rotation.begin());
    std::copy(shift.val, shift.val + 3, pose.translation.begin());
    return pose;
}

void check_pose(const Pose& pose, const std::string& path) {
    if (!is_rotation(turn_of(pose))) {
        refuse_calibration(path,
                           "T_cam_imu: the matrix that turns the inertial sensor's axes to the left camera's is no "
                           "rotation: its rows must have length 1 and be at right angles");
    }
    constexpr double most_mm = 100000;
    for (const double length : pose.translation) {
        if (!(std::abs(length) <= most_mm)) {
            refuse_calibration(path, "T_cam_imu: found an inertial sensor that is " + base::number_text(length) +
                                         " mm away from the left camera, allowed is 100 m at most: is the unit "
                                         "right?");
        }
    }
}

}  // namespace

Pose pose_of_rows(std::span<const double> rows) {
    return {{rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10]},
            {rows[3], rows[7], rows[11]}};
}

Pose inverse(const Pose& pose) {
    const cv::Matx33d back = turn_of(pose).t();
    return pose_of(back, -(back * cv::Vec3d(pose.translation.data())));
}

Pose chained(const Pose& first, const Pose& second) {
    return pose_of(turn_of(second) * turn_of(first),
                   turn_of(second) * cv::Vec3d(first.translation.data()) + cv::Vec3d(second.translation.data()));
}

void check_inertial(const InertialCalibration& inertial, const std::string& path) {
    if (inertial.to_left_camera) {
        check_pose(*inertial.to_left_camera, path);
    }
    constexpr double most_s = 60;
    constexpr double most_noise = 1000;
    for (const auto& [key, member] : inertial_numbers) {
        const std::optional<double>& number = inertial.*member;
        const bool is_time = member == &InertialCalibration::time_offset_s;
        const bool fits = !number || (is_time ? std::abs(*number) <= most_s : *number > 0 && *number <= most_noise);
        if (!fits) {
            refuse_calibration(
                path, std::string(key) + ": found " + base::number_text(*number) + ", allowed is " +
                          (is_time ? "-60 to 60 s" : "more than 0, at most 1000: take it out if it is not known"));
        }
    }
}

}  // namespace disparityd::calibration
