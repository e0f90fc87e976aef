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
#include "calibration/formats/baseline_unit.h"
#include "calibration/formats/calibration_format.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/calibration_name.h"
#include "calibration/lens.h"

namespace disparityd::calibration {

namespace {

constexpr std::string_view text_version = "disparityd-calibration 1";
constexpr std::size_t longest_name = 200;  // bytes of a file's name in a message

CalibrationText load(const std::string& path) {
    CalibrationText file{path, base::read_text_file(path, "calibration")};
    if (file.text.find('\0') != std::string::npos) {
        refuse_calibration(path, "found bytes that are no text: this is another kind of file");
    }
    return file;
}

/// Refuses settings behind the name that say nothing about such a file, as they would not be applied.
void check_settings(const CalibrationName& name, CalibrationFormat format) {
    const bool lens = name.lens && format != CalibrationFormat::opencv && format != CalibrationFormat::ros;
    if (lens || (name.pair && format != CalibrationFormat::kitti)) {
        refuse_calibration(name.files.front(), std::string("is ") + format_name(format) + ", for which " +
                                                   (lens ? "model says nothing: it is for OpenCV and ROS"
                                                         : "pair says nothing: it is for KITTI") +
                                                   ": take it out");
    }
}

FileCalibration read_pair(const CalibrationName& name, const CalibrationText& first, const CalibrationText& second,
                          int width, int height) {
    const CalibrationFormat format = calibration_format(first.path, first.text);
    const CalibrationFormat other = calibration_format(second.path, second.text);
    check_settings(name, format);
    if (format == other && format == CalibrationFormat::ros) {
        return read_ros_calibration(first, second, width, height, name.lens);
    }
    if (format == other && format == CalibrationFormat::euroc) {
        return read_euroc_sensors(first, second, width, height);
    }
    if (format == other && format == CalibrationFormat::opencv) {
        return read_opencv_calibration(first, second, width, height, name.lens);
    }
    refuse_calibration(first.path,
                       "is " + format_name(format) + ", and " + base::printable(second.path, longest_name) + " is " +
                           format_name(other) +
                           "; allowed with a comma between them are two ROS camera_info files, two "
                           "sensor.yaml of EuRoC, or two of OpenCV with the cameras and the pose, and behind "
                           "any of them a file about the inertial sensor");
}

FileCalibration read_one(const CalibrationName& name, const CalibrationText& file, std::optional<KittiPair> pair,
                         int width, int height) {
    FileCalibration read;
    const CalibrationFormat format = calibration_format(file.path, file.text);
    check_settings(name, format);
    switch (format) {
        case CalibrationFormat::factory:
            read.calibration = read_factory_conf(file.path, file.text, width, height);
            // Cameras with 18 mm are made.
            read.least_baseline_mm = 15;
            return read;
        case CalibrationFormat::opencv: return read_opencv_calibration(file, file, width, height, name.lens);
        case CalibrationFormat::orbslam: return read_orbslam_settings(file, width, height);
        case CalibrationFormat::kalibr: return read_kalibr_camchain(file, width, height);
        case CalibrationFormat::middlebury:
            read.calibration = read_middlebury_calibration(file.path, file.text, width, height);
            return read;
        case CalibrationFormat::kitti:
            read.calibration = read_kitti_calibration(
                file.path, file.text, kitti_camera(file.path, file.text, name.pair ? name.pair : pair), width, height);
            read.unit_mm = 1000;
            return read;
        case CalibrationFormat::inertial:
            refuse_calibration(file.path,
                               "is about an inertial sensor alone: name the cameras before it, as "
                               "camchain.yaml,imu.yaml");
        case CalibrationFormat::ros:
        case CalibrationFormat::euroc: break;
    }
    refuse_calibration(file.path, "found " + format_name(format) + "; name both, as left.yaml,right.yaml");
}

FileCalibration read_files(const CalibrationName& name, std::optional<KittiPair> pair, int width, int height) {
    std::vector<CalibrationText> files;
    for (const std::string& path : name.files) {
        files.push_back(load(path));
    }
    const bool inertial =
        files.size() > 1 && calibration_format(files.back().path, files.back().text) == CalibrationFormat::inertial;
    const std::size_t cameras = files.size() - (inertial ? 1 : 0);
    if (cameras > 2) {
        refuse_calibration(files.back().path,
                           "is the third file, which is allowed to be about the inertial sensor "
                           "alone: Kalibr's imu.yaml or EuRoC's imu0/sensor.yaml");
    }
    FileCalibration read = cameras == 1 ? read_one(name, files[0], pair, width, height)
                                        : read_pair(name, files[0], files[1], width, height);
    if (inertial) {
        join_inertial_file(read, files.back());
    }
    return read;
}

void put(std::string& text, const std::string& key, const std::vector<double>& numbers) {
    text += key + " =";
    for (const double number : numbers) {
        text += ' ';
        text += base::number_text(number);
    }
    text += "\n";
}

void put_camera(std::string& text, const std::string& key, const CameraModel& camera) {
    put(text, key, {camera.fx, camera.fy, camera.cx, camera.cy});
    put(text, key + "_distortion", lens_coefficients(camera));
}

void check_range(double value, double least, double most, const std::string& what, const std::string& path) {
    if (!(value >= least && value <= most)) {
        refuse_calibration(path, what + ": found " + base::number_text(value) + ", allowed is " +
                                     base::number_text(least) + " to " + base::number_text(most));
    }
}

/// Numerator and denominator of the rational model may both be large.
void check_coefficients(const CameraModel& camera, const std::string& eye, const std::string& path) {
    const std::vector<double> coefficients = lens_coefficients(camera);
    const double most = coefficients.size() <= 5 ? 50 : 1000;
    for (const double k : coefficients) {
        check_range(k, -most, most, eye + " distortion", path);
    }
    constexpr double largest_tilt = 1;  // rad
    if (camera.lens == LensModel::pinhole) {
        check_range(camera.distortion[12], -largest_tilt, largest_tilt, eye + " tau x", path);
        check_range(camera.distortion[13], -largest_tilt, largest_tilt, eye + " tau y", path);
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
        refuse_calibration(path,
                           "the matrix that turns the left camera to the right one is no rotation: its rows must have "
                           "length 1 and be at right angles");
    }
    constexpr double degrees = 180 / std::numbers::pi;
    const double angle = std::acos(std::clamp((r[0] + r[4] + r[8] - 1) / 2, -1.0, 1.0)) * degrees;
    check_range(std::round(angle), 0, 45, "degrees between the directions of the two cameras", path);
}

/// Checks that the right camera stands to the right of the left one.
void check_side_by_side(const StereoCalibration& calibration, const std::string& path) {
    const auto& t = calibration.translation;
    if (t[0] >= 0) {
        refuse_calibration(path,
                           "T: found x " + base::number_text(t[0]) +
                               " mm, expected less than 0: the right camera lies left of the left one: exchange "
                               "the two (left and right, in the files and in their order), or, if R and T are the "
                               "pose of the right camera as the left one sees it, give the inverse, which takes "
                               "points of the left camera to the right one");
    }
    // Cameras that are turned by 45 degrees to each other, the most that is allowed, have 0.42 at most.
    constexpr double largest_part = 0.5;
    for (const auto& [length, axis] : {std::pair(t[1], "y"), {t[2], "z"}}) {
        if (!(std::abs(length) <= largest_part * -t[0])) {
            refuse_calibration(path, std::string("T: found ") + axis + " " + base::number_text(length) + " mm and x " +
                                         base::number_text(t[0]) +
                                         " mm, allowed is at most half as much as x: the two cameras do not stand side "
                                         "by side");
        }
    }
}

/// Adds what is known alone, so that calibrations without an inertial sensor keep their text.
void put_inertial(std::string& text, const InertialCalibration& inertial) {
    if (inertial.to_left_camera) {
        const auto& [r, t] = *inertial.to_left_camera;
        put(text, "T_cam_imu", {r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2]});
    }
    for (const auto& [key, member] : inertial_numbers) {
        if (inertial.*member) {
            put(text, std::string(key), {*(inertial.*member)});
        }
    }
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

void refuse_calibration(const std::string& path, const std::string& what) {
    throw std::invalid_argument("calibration " + base::printable(path, longest_name) + ": " + what);
}

void refuse_other_size(const std::string& path, const std::string& found, int width, int height) {
    refuse_calibration(path, "is for eyes of " + found + " pixels, the frames have " + base::size_text(width, height) +
                                 ": use a mode or a calibration of the other size");
}

void check_size_by_centre(const StereoCalibration& calibration, const std::string& path) {
    // What cameras have lies within a tenth of the middle; rectified images may be cut.
    const double least = calibration.rectified ? 0.25 : 0.35;
    for (const CameraModel* camera : {&calibration.left, &calibration.right}) {
        const double x = camera->cx / calibration.width;
        const double y = camera->cy / calibration.height;
        if (!(x >= least && x <= 1 - least && y >= least && y <= 1 - least)) {
            refuse_calibration(path, "does not say for which size of images it is, and its principal point (" +
                                         base::number_text(camera->cx) + ", " + base::number_text(camera->cy) +
                                         ") is far from the middle of the frames' " +
                                         base::size_text(calibration.width, calibration.height) +
                                         ": use the calibration of this size, or write the size into the file (OpenCV: "
                                         "image_width, image_height)");
        }
    }
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
        check_coefficients(*camera, eye, path);
    }
    if (!calibration.rectified) {
        check_rotation(calibration.rotation, path);
    }
    const auto& t = calibration.translation;
    const double baseline = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
    if (!calibration.rectified || baseline != 0) {
        check_range(baseline, 0.5, 100000, "baseline in mm", path);
        check_side_by_side(calibration, path);
    }
    check_inertial(calibration.inertial, path);
}

StereoCalibration read_calibration(const std::string& path, int width, int height, std::optional<KittiPair> pair) {
    const CalibrationName name = parse_calibration_name(path);
    const FileCalibration read = read_files(name, pair, width, height);
    StereoCalibration calibration = settle_unit(read, name.unit_mm, path);
    calibration.origin = path;
    check_plausible(calibration, path);
    check_given_results(read.given, calibration, name.unit_mm.value_or(read.unit_mm));
    return calibration;
}

StereoCalibration scaled(const StereoCalibration& calibration, int width, int height) {
    const double across = static_cast<double>(width) / calibration.width;
    const double down = static_cast<double>(height) / calibration.height;
    if (std::abs(across * calibration.height - height) > 1) {  // a size is rounded to whole pixels
        throw std::invalid_argument(
            std::to_string(width) + "x" + std::to_string(height) + " has not the ratio of " +
            std::to_string(calibration.width) + "x" + std::to_string(calibration.height) +
            ": such a mode shows another part of the sensor, or is stretched; calibrate it by itself");
    }
    StereoCalibration result = calibration;
    result.width = width;
    result.height = height;
    for (CameraModel* eye : {&result.left, &result.right}) {
        eye->fx *= across;
        eye->fy *= down;
        eye->cx = (eye->cx + 0.5) * across - 0.5;  // the middle of the first pixel is 0
        eye->cy = (eye->cy + 0.5) * down - 0.5;
    }
    return result;
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
    put_inertial(text, calibration.inertial);
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
        const auto coefficients = values.find(key + "_distortion");
        if (coefficients == values.end() || !set_lens_coefficients(model, coefficients->second)) {
            throw std::invalid_argument("calibration of " + origin + ": '" + key +
                                        "_distortion' is missing or damaged; 5, 8, 12 or 14 numbers are expected, or 4 "
                                        "of a fisheye lens");
        }
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
    if (values.contains("T_cam_imu")) {
        calibration.inertial.to_left_camera = pose_of_rows(take("T_cam_imu", 12));
    }
    for (const auto& [key, member] : inertial_numbers) {
        if (values.contains(key)) {
            calibration.inertial.*member = take(key, 1)[0];
        }
    }
    calibration.origin = origin;
    check_plausible(calibration, origin);
    return calibration;
}

}  // namespace disparityd::calibration
