// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/opencv_storage.h"
#include "calibration/formats/pose_agreement.h"
#include "calibration/formats/rectified_eyes.h"

namespace disparityd::calibration {

namespace {

/// The settings of a file. Those of the tracker, the viewer and the IMU say nothing about the pair of cameras.
class Settings {
public:
    explicit Settings(const CalibrationText& file) : path_(file.path), storage_(file.path, file.text) {}

    bool has(const std::string& name) const { return storage_.has(name); }

    double number(const std::string& name) const {
        const auto number = base::parse_number(storage_.word(name));
        if (!number) {
            storage_.fail(name + ": found " + storage_.shown(name) + ", expected a number");
        }
        return *number;
    }
    double number_or(const std::string& name, double otherwise) const { return has(name) ? number(name) : otherwise; }

    std::vector<double> matrix(const std::string& name, std::size_t count) const {
        const auto matrix = storage_.matrix(name);
        if (!matrix || (count != 0 && matrix->numbers.size() != count)) {
            storage_.fail("has no matrix " + name + (count == 0 ? "" : " of " + std::to_string(count) + " numbers"));
        }
        return matrix->numbers;
    }

    std::string word(const std::string& name) const { return storage_.word(name); }

    /// Refuses keys of the sections that are used, but for those in `known`.
    void check_keys(std::initializer_list<std::string_view> known) const {
        constexpr std::array<std::string_view, 5> sections{"LEFT.", "RIGHT.", "Camera", "Stereo.", "lens"};
        for (const std::string& name : storage_.names()) {
            const bool used = std::any_of(sections.begin(), sections.end(),
                                          [&](std::string_view section) { return name.starts_with(section); });
            const std::string_view end = std::string_view(name).substr(name.find('.') + 1);
            const bool fits = std::any_of(known.begin(), known.end(), [&](std::string_view key) {
                return name == key || (key.starts_with('.') && end == key.substr(1));
            });
            if (used && !fits) {
                storage_.fail("has the key '" + base::printable(name) + "' (" + storage_.shown(name) +
                              "), which is not known and would not be applied: take it out if it says nothing about "
                              "lenses and sizes");
            }
        }
    }

    void check_size(int width, int height) const {
        for (const std::string section : {"Camera.", "Camera1.", "Camera2.", "LEFT.", "RIGHT."}) {
            const double found_width = number_or(section + "width", width);
            const double found_height = number_or(section + "height", height);
            if (found_width != width || found_height != height) {
                refuse_other_size(
                    path_,
                    base::number_text(found_width) + "x" + base::number_text(found_height) + " (" + section + "width)",
                    width, height);
            }
        }
    }

    [[noreturn]] void fail(const std::string& what) const { storage_.fail(what); }
    const std::string& path() const { return path_; }

private:
    std::string path_;
    OpencvStorage storage_;
};

/// Compares the camera of the rectified images, which ORB-SLAM 2 tracks with, with where rectification takes the left
/// eye to.
void check_tracked_camera(const Settings& file) {
    const auto projection = file.matrix("LEFT.P", 12);
    for (const auto& [key, expected] : {std::pair("Camera.fx", projection[0]),
                                        {"Camera.cx", projection[2]},
                                        {"Camera.fy", projection[5]},
                                        {"Camera.cy", projection[6]}}) {
        constexpr double rounding_px = 1;
        const double found = file.number_or(key, expected);
        if (!(std::abs(found - expected) <= rounding_px)) {
            file.fail(
                std::string(key) + ": found " + base::number_text(found) + ", expected " + base::number_text(expected) +
                " as LEFT.P has it, as it is the camera of the rectified images: they contradict each other; take "
                "the wrong one out");
        }
    }
    for (const char* key : {"Camera.k1", "Camera.k2", "Camera.k3", "Camera.p1", "Camera.p2"}) {
        if (file.number_or(key, 0) != 0) {
            file.fail(std::string(key) + ": found " + base::number_text(file.number(key)) +
                      ", expected 0, as rectified images have no distortion; that of the raw ones is LEFT.D and "
                      "RIGHT.D: take it out");
        }
    }
}

/// ORB-SLAM 2: both raw cameras, and where rectification takes them to, as ROS has it.
FileCalibration read_two(const Settings& file, LensModel lens, int width, int height) {
    FileCalibration result;
    StereoCalibration& calibration = result.calibration;
    file.check_keys({".K",           ".D",
                     ".R",           ".P",
                     ".width",       ".height",
                     "Camera.fx",    "Camera.fy",
                     "Camera.cx",    "Camera.cy",
                     "Camera.k1",    "Camera.k2",
                     "Camera.k3",    "Camera.p1",
                     "Camera.p2",    "Camera.bf",
                     "Camera.fps",   "Camera.RGB",
                     "Camera.type",  "Camera.name",
                     "Camera.setup", "Camera.color_order"});
    for (const auto& [camera, eye] :
         {std::pair(&calibration.left, std::string("LEFT")), {&calibration.right, "RIGHT"}}) {
        *camera = camera_of_matrix(file.path(), eye + ".K", file.matrix(eye + ".K", 9));
        set_lens(*camera, file.path(), eye + ".D", file.matrix(eye + ".D", 0), lens);
    }
    const cv::Matx33d left_turn(file.matrix("LEFT.R", 9).data());
    const cv::Matx33d right_turn(file.matrix("RIGHT.R", 9).data());
    const double shift = metre_mm * rectified_eyes({file.path(), "LEFT.P", file.matrix("LEFT.P", 12)},
                                                   {file.path(), "RIGHT.P", file.matrix("RIGHT.P", 12)}, width, height)
                                        .shift;
    check_tracked_camera(file);
    if (file.has("Camera.bf")) {
        const double f = file.has("Camera.fx") ? file.number("Camera.fx") : file.matrix("RIGHT.P", 12)[0];
        const double baseline = metre_mm * file.number("Camera.bf") / f;
        if (!(std::abs(baseline + shift) <= largest_baseline_share * std::abs(shift))) {
            file.fail("Camera.bf: found " + base::number_text(file.number("Camera.bf")) + ", a baseline of " +
                      base::number_text(baseline) + " mm, and LEFT.P and RIGHT.P give " + base::number_text(-shift) +
                      " mm: they contradict each other; take the wrong one out");
        }
    }
    const cv::Matx33d rotation = right_turn.t() * left_turn;
    const cv::Vec3d translation = right_turn.t() * cv::Vec3d(shift, 0, 0);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(translation.val, translation.val + 3, calibration.translation.begin());
    return result;
}

/// ORB-SLAM 3: both raw cameras, and the pose of the right one in the axes of the left one.
FileCalibration read_three(const Settings& file, LensModel lens) {
    FileCalibration result;
    StereoCalibration& calibration = result.calibration;
    const std::vector<const char*> coefficients = lens == LensModel::fisheye
                                                      ? std::vector<const char*>{"k1", "k2", "k3", "k4"}
                                                      : std::vector<const char*>{"k1", "k2", "p1", "p2", "k3"};
    for (const std::string eye : {"Camera1.", "Camera2."}) {
        for (const char* other : {"k4", "p1", "p2"}) {
            const bool used = std::any_of(coefficients.begin(), coefficients.end(),
                                          [&](std::string_view name) { return name == other; });
            if (!used && file.number_or(eye + other, 0) != 0) {
                file.fail(eye + other + ": found " + base::number_text(file.number(eye + other)) +
                          ", which the lens model of Camera.type does not have: correct the type, or take it out");
            }
        }
    }
    file.check_keys({"Camera1.k4",
                     "Camera2.k4",
                     "Camera1.overlappingBegin",
                     "Camera1.overlappingEnd",
                     "Camera2.overlappingBegin",
                     "Camera2.overlappingEnd",
                     "Camera.type",
                     "Camera1.fx",
                     "Camera1.fy",
                     "Camera1.cx",
                     "Camera1.cy",
                     "Camera1.k1",
                     "Camera1.k2",
                     "Camera1.k3",
                     "Camera1.p1",
                     "Camera1.p2",
                     "Camera2.fx",
                     "Camera2.fy",
                     "Camera2.cx",
                     "Camera2.cy",
                     "Camera2.k1",
                     "Camera2.k2",
                     "Camera2.k3",
                     "Camera2.p1",
                     "Camera2.p2",
                     "Camera.width",
                     "Camera.height",
                     "Camera.newWidth",
                     "Camera.newHeight",
                     "Camera.fps",
                     "Camera.RGB",
                     "Stereo.ThDepth",
                     "Stereo.T_c1_c2",
                     "Stereo.b"});
    for (const auto& [camera, eye] :
         {std::pair(&calibration.left, std::string("Camera1.")), {&calibration.right, "Camera2."}}) {
        std::vector<double> numbers;
        for (const char* name : coefficients) {
            numbers.push_back(file.number_or(eye + name, 0));
        }
        *camera = {
            file.number(eye + "fx"), file.number(eye + "fy"), file.number(eye + "cx"), file.number(eye + "cy"), {}};
        set_lens(*camera, file.path(), eye + "k1", numbers, lens);
    }
    const cv::Matx44d pose(file.matrix("Stereo.T_c1_c2", 16).data());
    const cv::Matx33d rotation = pose.get_minor<3, 3>(0, 0).t();
    const cv::Vec3d centre(pose(0, 3), pose(1, 3), pose(2, 3));
    const cv::Vec3d translation = -metre_mm * (rotation * centre);
    const double baseline = cv::norm(centre);
    if (!(std::abs(file.number_or("Stereo.b", baseline) - baseline) <= largest_baseline_share * baseline)) {
        file.fail("Stereo.b: found " + base::number_text(file.number("Stereo.b")) + ", expected " +
                  base::number_text(baseline) +
                  ", the length of the translation of Stereo.T_c1_c2: they contradict each other; take the wrong one "
                  "out");
    }
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(translation.val, translation.val + 3, calibration.translation.begin());
    return result;
}

}  // namespace

FileCalibration read_orbslam_settings(const CalibrationText& text, int width, int height) {
    const Settings file(text);
    if (file.has("Camera.type") && plain_name(file.word("Camera.type")) == "rectified") {
        file.fail(
            "Camera.type: found 'Rectified': settings for images that are rectified already are not read; allowed "
            "is PinHole with both raw cameras");
    }
    const LensModel lens =
        file.has("Camera.type") ? named_lens(file.path(), "Camera.type", file.word("Camera.type")) : LensModel::pinhole;
    file.check_size(width, height);
    if (!file.has("LEFT.K") && !file.has("Camera1.fx")) {
        file.fail(
            "has the settings of one camera: LEFT.K, LEFT.D, LEFT.R, LEFT.P and those of RIGHT are needed, or "
            "Camera1.fx ..., Camera2.fx ... and Stereo.T_c1_c2");
    }
    FileCalibration result = file.has("LEFT.K") ? read_two(file, lens, width, height) : read_three(file, lens);
    result.unit_mm = metre_mm;
    result.calibration.width = width;
    result.calibration.height = height;
    if (!file.has("Camera.width") && !file.has("LEFT.width")) {
        check_size_by_centre(result.calibration, text.path);
    }
    return result;
}

}  // namespace disparityd::calibration
