// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

namespace {

constexpr std::string_view text_version = "disparityd-calibration 1";

enum class Format { factory, opencv, ros, middlebury, kitti };

Format format_of(const std::string& path, const std::string& text) {
    if (text.starts_with("%YAML") || text.starts_with("<?xml")) {
        return Format::opencv;
    }
    if (text.find("cam0=") != std::string::npos || text.find("cam0 =") != std::string::npos) {
        return Format::middlebury;
    }
    if (text.find("P0:") != std::string::npos || text.find("P_rect_0") != std::string::npos ||
        text.find("P2:") != std::string::npos) {
        return Format::kitti;
    }
    if (text.find("camera_matrix") != std::string::npos) {
        return Format::ros;
    }
    if (base::trim(text).starts_with('[') || base::lower_case(path).ends_with(".conf")) {
        return Format::factory;
    }
    // Comments may come before the first section.
    for (const std::string_view line : base::split(text, '\n')) {
        const std::string_view content = base::trim(line);
        if (!content.empty() && content[0] != '#' && content[0] != ';') {
            if (content[0] == '[') {
                return Format::factory;
            }
            break;
        }
    }
    throw std::invalid_argument("calibration " + path +
                                ": no known format; allowed are a factory .conf, OpenCV YAML or XML, a pair of ROS "
                                "camera_info files (left.yaml,right.yaml), Middlebury's calib.txt and KITTI's");
}

StereoCalibration read_pair(const std::string& first, const std::string& second, int width, int height) {
    const std::string text = base::read_text_file(first, "calibration");
    if (format_of(first, text) == Format::ros) {
        return read_ros_calibration(first, second, width, height);
    }
    return read_opencv_calibration(first, second, width, height);
}

StereoCalibration read_one(const std::string& path, int width, int height) {
    const std::string text = base::read_text_file(path, "calibration");
    switch (format_of(path, text)) {
        case Format::factory: return read_factory_conf(path, text, width, height);
        case Format::opencv: return read_opencv_calibration(path, {}, width, height);
        case Format::middlebury: return read_middlebury_calibration(path, text, width, height);
        case Format::kitti:
            return read_kitti_calibration(
                path, text,
                text.find("P2:") != std::string::npos || text.find("P_rect_02:") != std::string::npos ? 2 : 0, width,
                height);
        case Format::ros: break;
    }
    throw std::invalid_argument("calibration " + path +
                                ": found the ROS camera_info of one camera; name both, as left.yaml,right.yaml");
}

void put(std::string& text, const std::string& key, std::initializer_list<double> numbers) {
    text += key + " =";
    for (const double number : numbers) {
        text += ' ';
        text += base::number_text(number);
    }
    text += "\n";
}

void put_camera(std::string& text, const std::string& key, const CameraModel& camera) {
    put(text, key, {camera.fx, camera.fy, camera.cx, camera.cy});
    const auto& k = camera.distortion;
    put(text, key + "_distortion", {k[0], k[1], k[2], k[3], k[4]});
}

void check_range(double value, double least, double most, const std::string& what, const std::string& path) {
    if (!(value >= least && value <= most)) {
        throw std::invalid_argument("calibration " + path + ": " + what + ": found " + base::number_text(value) +
                                    ", allowed is " + base::number_text(least) + " to " + base::number_text(most));
    }
}

/// Checks for rows of length 1 at right angles, in a right-handed order. The tolerance allows for rounded numbers.
void check_rotation(const std::array<double, 9>& r, const std::string& path) {
    constexpr double tolerance = 0.01;
    const auto product = [&r](std::size_t a, std::size_t b) {
        return r[a] * r[b] + r[a + 1] * r[b + 1] + r[a + 2] * r[b + 2];
    };
    bool good =
        r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]) >
        0;
    for (std::size_t a = 0; a < 9; a += 3) {
        for (std::size_t b = a; b < 9; b += 3) {
            // Written so that NaN is refused, too.
            good = good && std::abs(product(a, b) - (a == b ? 1 : 0)) < tolerance;
        }
    }
    if (!good) {
        throw std::invalid_argument("calibration " + path +
                                    ": the matrix that turns the left camera to the right one is no rotation: its rows "
                                    "must have length 1 and be at right angles");
    }
    constexpr double degrees = 180 / std::numbers::pi;
    const double angle = std::acos(std::clamp((r[0] + r[4] + r[8] - 1) / 2, -1.0, 1.0)) * degrees;
    check_range(std::round(angle), 0, 45, "degrees between the directions of the two cameras", path);
}

using NamedNumbers = std::map<std::string, std::vector<double>, std::less<>>;

/// Reads the lines "name = numbers" below the first, which must name the version. Damaged lines have no numbers.
NamedNumbers named_numbers(const std::string& text, const std::string& origin) {
    NamedNumbers values;
    bool first = true;
    for (const std::string_view line : base::split(text, '\n')) {
        if (first) {
            first = false;
            if (base::trim(line) != text_version) {
                throw std::invalid_argument("calibration of " + origin + ": found '" + base::printable(line) +
                                            "', this version reads '" + std::string(text_version) + "'");
            }
            continue;
        }
        const auto equals = line.find('=');
        if (equals != std::string_view::npos) {
            values[std::string(base::trim(line.substr(0, equals)))] =
                base::parse_numbers(line.substr(equals + 1), " \t\r").value_or(std::vector<double>());
        }
    }
    return values;
}

}  // namespace

void refuse_other_size(const std::string& path, const std::string& found, int width, int height) {
    throw std::invalid_argument("calibration " + path + ": is for eyes of " + found + " pixels, the frames have " +
                                std::to_string(width) + "x" + std::to_string(height) +
                                ": use a mode or a calibration of the other size");
}

void check_plausible(const StereoCalibration& calibration, const std::string& path) {
    const bool focal_known = !calibration.rectified || calibration.left.fx != 0;
    for (const auto& [camera, name] : {std::pair(&calibration.left, "left"), std::pair(&calibration.right, "right")}) {
        const std::string eye(name);
        if (focal_known) {
            check_range(camera->fx, 0.1 * calibration.width, 20.0 * calibration.width, eye + " fx", path);
            check_range(camera->fy, 0.1 * calibration.width, 20.0 * calibration.width, eye + " fy", path);
        }
        // The centre may lie outside a part of a rectified image.
        const double beyond = calibration.rectified ? 10 : 0;
        check_range(camera->cx, -beyond * calibration.width, (1 + beyond) * calibration.width, eye + " cx", path);
        check_range(camera->cy, -beyond * calibration.height, (1 + beyond) * calibration.height, eye + " cy", path);
        for (const double k : camera->distortion) {
            check_range(k, -50, 50, eye + " distortion", path);
        }
    }
    if (!calibration.rectified) {
        check_rotation(calibration.rotation, path);
    }
    const auto& t = calibration.translation;
    const double baseline = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
    if (!calibration.rectified || baseline != 0) {
        check_range(baseline, 0.5, 100000, "baseline in mm", path);
        if (t[0] >= 0) {
            throw std::invalid_argument("calibration " + path +
                                        ": the right camera lies left of the left one: exchange the two");
        }
    }
}

StereoCalibration read_calibration(const std::string& path, int width, int height) {
    const auto comma = path.find(',');
    StereoCalibration calibration = comma == std::string::npos
                                        ? read_one(path, width, height)
                                        : read_pair(path.substr(0, comma), path.substr(comma + 1), width, height);
    check_plausible(calibration, path);
    return calibration;
}

std::string to_text(const StereoCalibration& calibration) {
    std::string text(text_version);
    text += "\n";
    put(text, "size", {static_cast<double>(calibration.width), static_cast<double>(calibration.height)});
    put(text, "rectified", {calibration.rectified ? 1.0 : 0.0});
    put_camera(text, "left", calibration.left);
    put_camera(text, "right", calibration.right);
    const auto& r = calibration.rotation;
    put(text, "rotation", {r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]});
    const auto& t = calibration.translation;
    put(text, "translation", {t[0], t[1], t[2]});
    return text;
}

StereoCalibration calibration_from_text(const std::string& text, const std::string& origin) {
    const NamedNumbers values = named_numbers(text, origin);
    const auto take = [&](std::string_view key, std::size_t count) -> const std::vector<double>& {
        const auto found = values.find(key);
        if (found == values.end() || found->second.size() != count) {
            throw std::invalid_argument("calibration of " + origin + ": '" + std::string(key) +
                                        "' is missing or damaged; " + std::to_string(count) + " numbers are expected");
        }
        return found->second;
    };
    const auto camera = [&](const std::string& key) {
        const auto& pinhole = take(key, 4);
        CameraModel model{pinhole[0], pinhole[1], pinhole[2], pinhole[3], {}};
        const auto& k = take(key + "_distortion", 5);
        std::copy(k.begin(), k.end(), model.distortion.begin());
        return model;
    };
    StereoCalibration calibration;
    const auto& size = take("size", 2);
    check_range(size[0], 1, 65535, "width", origin);
    check_range(size[1], 1, 65535, "height", origin);
    calibration.width = static_cast<int>(size[0]);
    calibration.height = static_cast<int>(size[1]);
    calibration.rectified = take("rectified", 1)[0] != 0;
    calibration.left = camera("left");
    calibration.right = camera("right");
    const auto& rotation = take("rotation", 9);
    std::copy(rotation.begin(), rotation.end(), calibration.rotation.begin());
    const auto& translation = take("translation", 3);
    std::copy(translation.begin(), translation.end(), calibration.translation.begin());
    calibration.origin = origin;
    check_plausible(calibration, origin);
    return calibration;
}

}  // namespace disparityd::calibration
