// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/calibration_format.h"

#include <algorithm>
#include <set>

#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/opencv_keys.h"

namespace disparityd::calibration {

namespace {

using Names = std::set<std::string, std::less<>>;

/// Returns what stands before the separator in each line, without quotes; `indented`: not only in lines that begin at
/// the left.
Names names_before(const std::string& text, char separator, bool indented) {
    Names names;
    for (const std::string_view line : base::split(text, '\n')) {
        const auto at = line.find(separator);
        const std::string_view content = indented ? base::trim(line) : line;
        if (at == std::string_view::npos || content.empty() || (!indented && content[0] == ' ')) {
            continue;
        }
        std::string_view name = base::trim(line.substr(0, at));
        if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front()) {
            name = name.substr(1, name.size() - 2);
        }
        names.emplace(name);
    }
    return names;
}

/// Returns whether a section comes first, behind comments.
bool begins_with_section(const std::string& text) {
    for (const std::string_view line : base::split(text, '\n')) {
        const std::string_view content = base::trim(line);
        if (!content.empty() && content[0] != '#' && content[0] != ';') {
            return content[0] == '[';
        }
    }
    return false;
}

bool has_opencv_key(const Names& names) {
    for (const std::string& name : names) {
        for (const auto& keys : {left_eye_keys.matrix, right_eye_keys.matrix, left_eye_keys.distortion, rotation_keys,
                                 translation_keys, single_camera_keys}) {
            if (is_among(name, keys)) {
                return true;
            }
        }
    }
    return false;
}

bool is_inertial(const Names& names) {
    const bool has_numbers = std::any_of(inertial_numbers.begin(), inertial_numbers.end(),
                                         [&](const InertialNumber& number) { return names.contains(number.key); });
    return names.contains("imu0") || (names.contains("sensor_type") && !names.contains("intrinsics")) ||
           (has_numbers && !has_opencv_key(names));
}

}  // namespace

CalibrationFormat calibration_format(const std::string& path, const std::string& text) {
    const bool json = base::trim(text).starts_with('{');
    if (json && text.find("\"distortion_model\"") != std::string::npos &&
        (text.find("\"P\"") != std::string::npos || text.find("\"p\"") != std::string::npos ||
         text.find("\"projection_matrix\"") != std::string::npos)) {
        return CalibrationFormat::ros;
    }
    if (text.starts_with("<?xml") || text.starts_with("<opencv_storage") || json) {
        return CalibrationFormat::opencv;
    }
    if (text.find("\ncamera matrix") != std::string::npos) {
        refuse_calibration(path,
                           "is the INI text of ROS's camera_calibration (ost.txt), which is not read: give its YAML of "
                           "both eyes (ost.yaml), as left.yaml,right.yaml");
    }
    if (begins_with_section(text) || base::lower_case(path).ends_with(".conf")) {
        return CalibrationFormat::factory;
    }
    const Names assigned = names_before(text, '=', true);
    if (assigned.contains("cam0") || assigned.contains("cam1")) {
        return CalibrationFormat::middlebury;
    }
    const Names names = names_before(text, ':', false);
    if (is_inertial(names)) {
        return CalibrationFormat::inertial;
    }
    const bool has_matrices = names_before(text, ':', true).contains("rows");
    for (const char* key : {"P0", "P1", "P2", "P3", "P_rect_00", "P_rect_02"}) {
        // OpenCV's P1 and P2 are results of rectification.
        if (names.contains(key) && !text.starts_with("%YAML") && !has_matrices && !has_opencv_key(names)) {
            return CalibrationFormat::kitti;
        }
    }
    if (names.contains("cam0") || names.contains("cam1")) {
        return CalibrationFormat::kalibr;
    }
    if (names.contains("T_BS") || names.contains("sensor_type")) {
        return CalibrationFormat::euroc;
    }
    if (names.contains("LEFT.K") || names.contains("Camera.fx") || names.contains("Camera1.fx") ||
        names.contains("Camera.type")) {
        return CalibrationFormat::orbslam;
    }
    const bool is_message = names.contains("width") && ((names.contains("K") && names.contains("P")) ||
                                                        (names.contains("k") && names.contains("p")));
    if (names.contains("projection_matrix") || names.contains("rectification_matrix") || is_message) {
        return CalibrationFormat::ros;
    }
    if (text.starts_with("%YAML") || has_matrices || has_opencv_key(names)) {
        return CalibrationFormat::opencv;
    }
    refuse_calibration(
        path,
        "no known format; allowed are a factory .conf, OpenCV YAML, JSON or XML, a pair of ROS "
        "camera_info files (left.yaml,right.yaml), settings of ORB-SLAM, Kalibr's camchain, a pair of "
        "EuRoC's sensor.yaml (cam0/sensor.yaml,cam1/sensor.yaml), and calib.txt of Middlebury, ETH3D and KITTI");
}

std::string format_name(CalibrationFormat format) {
    switch (format) {
        case CalibrationFormat::factory: return "a factory .conf";
        case CalibrationFormat::opencv: return "an OpenCV file";
        case CalibrationFormat::ros: return "the ROS camera_info of one camera";
        case CalibrationFormat::orbslam: return "settings of ORB-SLAM";
        case CalibrationFormat::kalibr: return "Kalibr's camchain";
        case CalibrationFormat::euroc: return "EuRoC's sensor.yaml of one camera";
        case CalibrationFormat::middlebury: return "Middlebury's calib.txt";
        case CalibrationFormat::kitti: return "KITTI's calibration";
        case CalibrationFormat::inertial: return "about an inertial sensor";
    }
    return "a calibration";
}

}  // namespace disparityd::calibration
