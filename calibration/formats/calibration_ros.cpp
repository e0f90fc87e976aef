// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/rectified_eyes.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

namespace {

// One camera_info file.
class CameraInfo {
public:
    explicit CameraInfo(const CalibrationText& file)
        : path_(file.path), root_(read_yaml_map(file.path, file.text, "YAML file")) {
        constexpr std::array<std::string_view, 9> known{
            "image_width",  "image_height",      "camera_name",          "camera_matrix",          "distortion_model",
            "camera_model", "projection_matrix", "rectification_matrix", "distortion_coefficients"};
        for (const auto& item : root_) {
            const std::string name = word_of(item.first);
            if (std::find(known.begin(), known.end(), name) == known.end()) {
                fail("has the key '" + base::printable(name) +
                     "', which is not known and would not be applied; allowed are image_width, image_height, "
                     "camera_name, camera_matrix, distortion_model, distortion_coefficients, rectification_matrix and "
                     "projection_matrix: take it out if it says nothing about lens and size");
            }
        }
    }

    int integer(const char* key) const {
        const auto number = base::parse_number(scalar(root_[key], key));
        if (!number || *number < 1 || *number > 65535 || *number != static_cast<int>(*number)) {
            fail(std::string(key) + ": found '" + base::printable(scalar(root_[key], key)) +
                 "', expected a number of pixels");
        }
        return static_cast<int>(*number);
    }

    /// Returns the numbers of a matrix; `count` 0 = as many as there are.
    std::vector<double> matrix(const char* key, std::size_t count) const {
        const YAML::Node entry = root_[key];
        const YAML::Node data = entry && entry.IsMap() ? entry["data"] : YAML::Node();
        if (!data || !data.IsSequence() || (count != 0 && data.size() != count)) {
            fail(std::string(key) + ": has no data of " + (count == 0 ? "numbers" : base::counted(count, "number")) +
                 (data && data.IsSequence() ? ", found " + std::to_string(data.size()) : ""));
        }
        std::vector<double> numbers;
        for (const YAML::Node& node : data) {
            const auto number = base::parse_number(scalar(node, key));
            if (!number) {
                fail(std::string(key) + ": found '" + base::printable(scalar(node, key)) + "', expected a number");
            }
            numbers.push_back(*number);
        }
        return numbers;
    }

    std::optional<std::string> text(const char* key) const {
        return root_[key] ? std::optional(scalar(root_[key], key)) : std::nullopt;
    }

    const std::string& path() const { return path_; }

    [[noreturn]] void fail(const std::string& what) const { refuse_calibration(path_, what); }

private:
    std::string scalar(const YAML::Node& node, const char* key) const {
        if (!node || !node.IsScalar()) {
            fail(std::string("has no ") + key);
        }
        return node.Scalar();
    }

    std::string path_;
    const YAML::Node root_;
};

CameraModel camera_of(const CameraInfo& file, bool brown) {
    bool named = false;
    for (const char* key : {"distortion_model", "camera_model"}) {
        if (const auto model = file.text(key)) {
            check_lens_model(file.path(), key, *model);
            // "pinhole" says nothing about the lens's distortion.
            named = named || std::string_view(key) == "distortion_model";
        }
    }
    CameraModel camera = camera_of_matrix(file.path(), "camera_matrix", file.matrix("camera_matrix", 9));
    const auto d = file.matrix("distortion_coefficients", 0);
    camera.distortion = brown_coefficients(file.path(), "distortion_coefficients", d);
    if (!named && !brown && d.size() == 4 && camera.distortion != std::array<double, 5>{}) {
        file.fail(
            "distortion_coefficients: found 4 coefficients and no distortion_model: they may be Brown's (k1 k2 p1 "
            "p2) or a fisheye's: write 'distortion_model: plumb_bob' into the file if they are Brown's");
    }
    return camera;
}

void check_size(const CameraInfo& file, int width, int height) {
    const int found_width = file.integer("image_width");
    const int found_height = file.integer("image_height");
    if (found_width != width || found_height != height) {
        refuse_other_size(file.path(), std::to_string(found_width) + "x" + std::to_string(found_height), width, height);
    }
}

/// Tells files of single cameras, and files in the wrong order.
void check_shifts(const EyeProjection& left, const EyeProjection& right) {
    const double left_shift = left.matrix[3];
    const double right_shift = right.matrix[3];
    if (left_shift == right_shift) {
        refuse_calibration(right.path,
                           "projection_matrix: found Tx " + base::number_text(right_shift) +
                               " (row 1, column 4) here and in " + base::printable(left.path, 200) +
                               ": these are the calibrations of two single cameras, or twice the same one, and how the "
                               "right one stands to the left one is missing: calibrate both together, as disparityctl "
                               "calibrate does");
    }
    if (right_shift > left_shift) {
        refuse_calibration(right.path,
                           "projection_matrix: found Tx " + base::number_text(right_shift) + ", and " +
                               base::number_text(left_shift) + " in " + base::printable(left.path, 200) +
                               ": the right camera's is the smaller one, -f B: exchange the two files, left "
                               "first: " +
                               base::printable(right.path, 200) + "," + base::printable(left.path, 200));
    }
}

}  // namespace

FileCalibration read_ros_calibration(const CalibrationText& left, const CalibrationText& right, int width, int height,
                                     bool brown) {
    const CameraInfo left_file(left);
    const CameraInfo right_file(right);
    check_size(left_file, width, height);
    check_size(right_file, width, height);
    FileCalibration result;
    result.unit_mm = metre_mm;
    StereoCalibration& calibration = result.calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.left = camera_of(left_file, brown);
    calibration.right = camera_of(right_file, brown);

    // camera_info holds the rotations to the rectified frame, and in the projections where each eye stands, in metres:
    // X_rect = R1 X_left + (Tx1 / f, 0, 0) and X_rect = R2 X_right + (Tx2 / f, 0, 0) as seen from one and the same
    // point, so that the baseline is the difference of both.
    const cv::Matx33d left_turn(left_file.matrix("rectification_matrix", 9).data());
    const cv::Matx33d right_turn(right_file.matrix("rectification_matrix", 9).data());
    const EyeProjection left_eye{left.path, "projection_matrix", left_file.matrix("projection_matrix", 12)};
    const EyeProjection right_eye{right.path, "projection_matrix", right_file.matrix("projection_matrix", 12)};
    check_shifts(left_eye, right_eye);
    const double shift = metre_mm * rectified_eyes(left_eye, right_eye, width, height).shift;
    const cv::Matx33d rotation = right_turn.t() * left_turn;
    const cv::Vec3d translation = right_turn.t() * cv::Vec3d(shift, 0, 0);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(translation.val, translation.val + 3, calibration.translation.begin());
    return result;
}

}  // namespace disparityd::calibration
