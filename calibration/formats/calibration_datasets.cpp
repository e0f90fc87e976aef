// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/pose_agreement.h"
#include "calibration/formats/rectified_eyes.h"

namespace disparityd::calibration {

namespace {

using Entries = std::map<std::string, std::string, std::less<>>;

/// Reads lines of key, separator and value. `known` are the keys that are used, or say nothing about the geometry.
Entries read_entries(const std::string& path, const std::string& text, char separator,
                     const std::vector<std::string_view>& known, const std::string& format) {
    Entries entries;
    int number = 0;
    for (const std::string_view raw : base::split(text, '\n')) {
        ++number;
        const std::string_view line = base::trim(raw);
        if (line.empty()) {
            continue;
        }
        const auto at = std::min(line.find(separator), line.size());
        const std::string key(base::trim(line.substr(0, at)));
        const std::string where = "line " + std::to_string(number) + ": found '" + base::printable(line) + "', ";
        if (at == line.size()) {
            refuse_calibration(path, where + "expected key" + separator + "value: this is no calibration of " + format);
        }
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            refuse_calibration(path, where + "a key that calibrations of " + format +
                                         " do not have and that would not be applied: take it out if it says nothing "
                                         "about the cameras");
        }
        if (!entries.emplace(key, base::trim(line.substr(at + 1))).second) {
            refuse_calibration(path, where + "a key that is there twice; once is allowed");
        }
    }
    return entries;
}

std::vector<double> numbers(const Entries& entries, const std::string& path, std::string_view key, std::size_t count) {
    const auto found = entries.find(key);
    if (found == entries.end()) {
        refuse_calibration(path, "has no entry " + std::string(key));
    }
    const auto values = base::parse_numbers(found->second, "[],; \t\r");
    if (!values || values->size() != count) {
        refuse_calibration(path, std::string(key) + ": found '" + base::printable(found->second) + "', expected " +
                                     base::counted(count, "number"));
    }
    return *values;
}

StereoCalibration rectified_calibration(const std::string& path, int width, int height) {
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.rectified = true;
    calibration.origin = path;
    return calibration;
}

/// Compares the offset of disparities that the file states with that of the two principal points.
void check_offset(const Entries& entries, const std::string& path, const StereoCalibration& calibration) {
    constexpr double rounding = 0.05;
    const double expected = calibration.right.cx - calibration.left.cx;
    const double found = entries.contains("doffs") ? numbers(entries, path, "doffs", 1)[0] : expected;
    if (!(std::abs(found - expected) <= rounding)) {
        refuse_calibration(path, "doffs: found " + base::number_text(found) +
                                     ", and the principal points of cam0 and cam1 give " +
                                     base::number_text(std::round(1000 * expected) / 1000) +
                                     " (cx1 - cx0): they contradict each other; use the calibration that belongs to "
                                     "the images");
    }
}

/// Compares what KITTI says about the raw cameras of a pair with their projections: both lead to the rectified images.
void check_raw_poses(const Entries& entries, const std::string& path, const std::array<std::string, 2>& cameras,
                     const std::array<EyeProjection, 2>& eyes) {
    std::array<cv::Matx33d, 2> turns;  // from camera 0 to the rectified camera
    std::array<cv::Vec3d, 2> centres;  // in the axes of camera 0, in metres
    for (const std::size_t eye : {std::size_t{0}, std::size_t{1}}) {
        for (const char* key : {"R_0", "T_0", "R_rect_0"}) {
            if (!entries.contains(key + cameras[eye])) {
                return;
            }
        }
        const cv::Matx33d raw(numbers(entries, path, "R_0" + cameras[eye], 9).data());
        turns[eye] = cv::Matx33d(numbers(entries, path, "R_rect_0" + cameras[eye], 9).data()) * raw;
        centres[eye] = -(raw.t() * cv::Vec3d(numbers(entries, path, "T_0" + cameras[eye], 3).data()));
    }
    const std::string keys = "R_0" + cameras[1] + ", T_0" + cameras[1] + ", R_rect_0" + cameras[1];
    const std::string advice = ": they contradict each other; use the calibration that belongs to the images";
    const double degrees = degrees_between(turns[1], turns[0]);
    if (!(degrees <= largest_turn_degrees)) {
        refuse_calibration(path, keys + ": found an eye that rectification turns by " + degrees_text(degrees) +
                                     " otherwise than the one of camera " + cameras[0] + ", expected at most " +
                                     degrees_text(largest_turn_degrees) + advice);
    }
    const auto seen = [&](std::size_t i) { return eyes[1].matrix[i] - eyes[0].matrix[i]; };
    const double f = eyes[0].matrix[0];
    const cv::Vec3d of_projections(-seen(3) / f, -seen(7) / f, -seen(11));
    const cv::Vec3d of_poses = turns[0] * (centres[1] - centres[0]);
    if (!(cv::norm(of_poses - of_projections) <= largest_baseline_share * cv::norm(of_projections))) {
        const auto millimetres = [](double metres) { return base::number_text(std::round(1e5 * metres) / 100); };
        refuse_calibration(path, keys + ": found a baseline of " + millimetres(of_poses[0]) + " mm, expected " +
                                     millimetres(of_projections[0]) + " as " + eyes[0].key + " and " + eyes[1].key +
                                     " have it" + advice);
    }
}

/// The keys of KITTI's files. Those of the raw cameras and of other sensors say nothing about rectified images.
std::vector<std::string_view> kitti_keys() {
    std::vector<std::string_view> keys{"calib_time",     "corner_dist",   "Tr",          "R0_rect",
                                       "R_rect",         "Tr_velo_cam",   "Tr_imu_velo", "Tr_velo_to_cam",
                                       "Tr_imu_to_velo", "Tr_cam_to_road"};
    static const std::vector<std::string> numbered = [] {
        std::vector<std::string> names;
        for (const std::string camera : {"0", "1", "2", "3"}) {
            names.push_back("P" + camera);
            for (const char* key : {"S_0", "K_0", "D_0", "R_0", "T_0", "S_rect_0", "R_rect_0", "P_rect_0"}) {
                names.push_back(key + camera);
            }
        }
        return names;
    }();
    keys.insert(keys.end(), numbered.begin(), numbered.end());
    return keys;
}

}  // namespace

StereoCalibration read_middlebury_calibration(const std::string& path, const std::string& text, int width, int height) {
    // Of the disparities that the scene has, and of the ground truth: matching does not depend on them.
    const Entries entries = read_entries(
        path, text, '=',
        {"cam0", "cam1", "doffs", "baseline", "width", "height", "ndisp", "isint", "vmin", "vmax", "dyavg", "dymax"},
        "Middlebury");
    const auto size_entry = [&](const char* key, int found) {
        const double expected = numbers(entries, path, key, 1)[0];
        if (expected != found) {
            refuse_calibration(path, std::string(key) + " is " + base::number_text(expected) +
                                         ", that of the frames is " + std::to_string(found) +
                                         ": use the calibration of the same resolution");
        }
    };
    size_entry("width", width);
    size_entry("height", height);
    StereoCalibration calibration = rectified_calibration(path, width, height);
    std::array<EyeProjection, 2> eyes;
    for (const std::size_t eye : {std::size_t{0}, std::size_t{1}}) {
        const std::string key = eye == 0 ? "cam0" : "cam1";
        const auto m = numbers(entries, path, key, 9);
        eyes[eye] = {path, key, {m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0}};
    }
    const RectifiedEyes both = rectified_eyes(eyes[0], eyes[1], width, height);
    calibration.left = both.left;
    calibration.right = both.right;
    check_offset(entries, path, calibration);
    calibration.translation = {-numbers(entries, path, "baseline", 1)[0], 0, 0};
    return calibration;
}

int kitti_camera(const std::string& path, const std::string& text, std::optional<KittiPair> pair) {
    const Entries entries = read_entries(path, text, ':', kitti_keys(), "KITTI");
    const auto has = [&](const char* key, const char* raw_key) {
        return entries.contains(key) || entries.contains(raw_key);
    };
    const bool grey = has("P0", "P_rect_00") && has("P1", "P_rect_01");
    const bool colour = has("P2", "P_rect_02") && has("P3", "P_rect_03");
    if (grey && colour && !pair) {
        refuse_calibration(path,
                           "has both of KITTI's pairs, and which one the images are of is not known: give the name "
                           "with ?pair=grey behind it for images of image_0 and image_1 (image_00, image_01), with "
                           "?pair=colour for those of image_2 and image_3");
    }
    return grey && (!colour || *pair == KittiPair::grey) ? 0 : 2;
}

StereoCalibration read_kitti_calibration(const std::string& path, const std::string& text, int first_camera, int width,
                                         int height) {
    const Entries entries = read_entries(path, text, ':', kitti_keys(), "KITTI");
    const bool raw_layout = entries.contains("P_rect_00") || entries.contains("P_rect_02");
    const auto key = [&](int camera) { return (raw_layout ? "P_rect_0" : "P") + std::to_string(camera); };
    StereoCalibration calibration = rectified_calibration(path, width, height);
    std::array<EyeProjection, 2> eyes;
    bool sized = false;
    for (const int i : {0, 1}) {
        const std::string number = std::to_string(first_camera + i);
        if (const std::string size_key = "S_rect_0" + number; raw_layout && entries.contains(size_key)) {
            const auto size = numbers(entries, path, size_key, 2);
            if (size[0] != width || size[1] != height) {
                refuse_other_size(path, base::number_text(size[0]) + "x" + base::number_text(size[1]), width, height);
            }
            sized = true;
        }
        eyes[static_cast<std::size_t>(i)] = {path, key(first_camera + i),
                                             numbers(entries, path, key(first_camera + i), 12)};
    }
    const RectifiedEyes both = rectified_eyes(eyes[0], eyes[1], width, height);
    if (raw_layout) {
        check_raw_poses(entries, path, {std::to_string(first_camera), std::to_string(first_camera + 1)}, eyes);
    }
    calibration.left = both.left;
    calibration.right = both.right;
    calibration.translation = {1000 * both.shift, 0, 0};
    if (!sized) {
        check_size_by_centre(calibration, path);
    }
    return calibration;
}

}  // namespace disparityd::calibration
