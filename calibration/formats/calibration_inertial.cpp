// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>

#include "base/message_text.h"
#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/yaml_numbers.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

namespace {

/// Returns the entries of the sensor: those of the file, or those below imu0, as Kalibr writes its results.
YAML::Node sensor_of(const std::string& path, const YAML::Node& root) {
    const YAML::Node inner = root["imu0"];
    if (!inner) {
        return root;
    }
    if (root.size() != 1 || !inner.IsMap()) {
        refuse_calibration(path,
                           "has more than the entries of imu0; one inertial sensor is allowed: take the others out");
    }
    return inner;
}

void check_keys(const std::string& path, const YAML::Node& sensor) {
    constexpr std::array<std::string_view, 9> known{"sensor_type", "comment", "T_BS",        "rate_hz", "rostopic",
                                                    "update_rate", "model",   "time_offset", "T_i_b"};
    for (const auto& item : sensor) {
        const std::string key = word_of(item.first);
        const bool is_number = std::any_of(inertial_numbers.begin(), inertial_numbers.end(),
                                           [&](const InertialNumber& number) { return key == number.key; });
        if (!is_number && std::find(known.begin(), known.end(), key) == known.end()) {
            refuse_calibration(path, "has the key '" + base::printable(key) +
                                         "', which is not known and would not be applied: take it out if it says "
                                         "nothing about how the samples must be corrected");
        }
    }
    for (const auto& [key, expected] : {std::pair("sensor_type", "imu"), {"model", "calibrated"}}) {
        if (const std::string word = word_of(sensor[key]); sensor[key] && word != expected) {
            refuse_calibration(path,
                               std::string(key) + ": found '" + base::printable(word) + "', expected " + expected);
        }
    }
}

/// Refuses what Kalibr states of a second sensor, which stands elsewhere than the first.
void check_is_first(const std::string& path, const YAML::Node& sensor) {
    if (sensor["T_i_b"] && yaml_pose(path, "T_i_b", sensor["T_i_b"]) != cv::Matx44d::eye()) {
        refuse_calibration(path, "T_i_b: found another pose than that of the first sensor, which T_cam_imu is of");
    }
    if (sensor["time_offset"] && yaml_number(path, "time_offset", sensor["time_offset"]) != 0) {
        refuse_calibration(path, "time_offset: found another one than 0, that of the first sensor");
    }
}

void join_pose(FileCalibration& cameras, const std::string& path, const cv::Matx44d& to_body) {
    if (cameras.left_to_body) {
        cameras.calibration.inertial.to_left_camera = chained(pose_of_metres(to_body), inverse(*cameras.left_to_body));
    } else if (to_body != cv::Matx44d::eye()) {
        refuse_calibration(path,
                           "T_BS: says where the sensor stands on a body, and the file of the cameras does not say "
                           "where they do: give T_cam_imu there, and take T_BS out");
    }
}

}  // namespace

void join_inertial_file(FileCalibration& cameras, const CalibrationText& file) {
    const YAML::Node root = read_yaml_map(file.path, file.text, "YAML file");
    const YAML::Node sensor = sensor_of(file.path, root);
    check_keys(file.path, sensor);
    check_is_first(file.path, sensor);
    for (const auto& [name, member] : inertial_numbers) {
        const std::string key(name);
        if (!sensor[key]) {
            continue;
        }
        const double found = yaml_number(file.path, key, sensor[key]);
        std::optional<double>& number = cameras.calibration.inertial.*member;
        if (number && *number != found) {
            refuse_calibration(file.path, key + ": found " + base::number_text(found) + ", and the cameras' file has " +
                                              base::number_text(*number) +
                                              ": they contradict each other; take the wrong one out");
        }
        number = found;
    }
    if (sensor["T_BS"]) {
        join_pose(cameras, file.path, yaml_pose(file.path, "T_BS", sensor["T_BS"]));
    }
}

}  // namespace disparityd::calibration
