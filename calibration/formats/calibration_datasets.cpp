// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <stdexcept>
#include <string>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

namespace {

using Entries = std::map<std::string, std::string, std::less<>>;

Entries read_entries(const std::string& text, char separator) {
    Entries entries;
    for (const std::string_view line : base::split(text, '\n')) {
        const auto at = line.find(separator);
        if (at != std::string_view::npos) {
            entries[std::string(base::trim(line.substr(0, at)))] = std::string(base::trim(line.substr(at + 1)));
        }
    }
    return entries;
}

std::vector<double> numbers(const Entries& entries, const std::string& path, std::string_view key, std::size_t count) {
    const auto found = entries.find(key);
    if (found == entries.end()) {
        throw std::invalid_argument("calibration " + path + ": has no entry " + std::string(key));
    }
    const auto values = base::parse_numbers(found->second, "[]; \t\r");
    if (!values || values->size() != count) {
        throw std::invalid_argument("calibration " + path + ": " + std::string(key) + ": found '" +
                                    base::printable(found->second) + "', expected " + std::to_string(count) +
                                    (count == 1 ? " number" : " numbers"));
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

void check_focal_length(double f, const std::string& path, const std::string& key) {
    if (!(f > 0)) {
        throw std::invalid_argument("calibration " + path + ": " + key + ": found a focal length of " +
                                    base::number_text(f) + ", allowed is more than 0");
    }
}

}  // namespace

StereoCalibration read_middlebury_calibration(const std::string& path, const std::string& text, int width, int height) {
    const Entries entries = read_entries(text, '=');
    const auto size_entry = [&](const char* key, int found) {
        const double expected = numbers(entries, path, key, 1)[0];
        if (expected != found) {
            throw std::invalid_argument("calibration " + path + ": " + key + " is " + base::number_text(expected) +
                                        ", that of the frames is " + std::to_string(found) +
                                        ": use the calibration of the same resolution");
        }
    };
    size_entry("width", width);
    size_entry("height", height);
    StereoCalibration calibration = rectified_calibration(path, width, height);
    for (const auto& [camera, key] : {std::pair(&calibration.left, "cam0"), std::pair(&calibration.right, "cam1")}) {
        const auto matrix = numbers(entries, path, key, 9);
        check_focal_length(matrix[0], path, key);
        *camera = {matrix[0], matrix[4], matrix[2], matrix[5], {}};
    }
    calibration.translation = {-numbers(entries, path, "baseline", 1)[0], 0, 0};
    return calibration;
}

StereoCalibration read_kitti_calibration(const std::string& path, const std::string& text, int first_camera, int width,
                                         int height) {
    const Entries entries = read_entries(text, ':');
    const bool raw_layout = entries.contains("P_rect_00") || entries.contains("P_rect_02");
    const auto key = [&](int camera) { return (raw_layout ? "P_rect_0" : "P") + std::to_string(camera); };
    StereoCalibration calibration = rectified_calibration(path, width, height);
    double shift[2] = {};
    for (int i = 0; i < 2; ++i) {
        const std::string number = std::to_string(first_camera + i);
        if (const std::string size_key = "S_rect_0" + number; raw_layout && entries.contains(size_key)) {
            const auto size = numbers(entries, path, size_key, 2);
            if (size[0] != width || size[1] != height) {
                refuse_other_size(path, base::number_text(size[0]) + "x" + base::number_text(size[1]), width, height);
            }
        }
        const auto p = numbers(entries, path, key(first_camera + i), 12);
        check_focal_length(p[0], path, key(first_camera + i));
        auto& eye = i == 0 ? calibration.left : calibration.right;
        eye = {p[0], p[5], p[2], p[6], {}};
        shift[i] = p[3] / p[0];
    }
    calibration.translation = {1000 * (shift[1] - shift[0]), 0, 0};
    return calibration;
}

}  // namespace disparityd::calibration
