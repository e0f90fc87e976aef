// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
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

/// The keys of a file, and what they are called in a message (`rostopic echo`, `ros2 topic echo`).
struct Spellings {
    std::string_view file, ros1, ros2;
};
constexpr std::array<Spellings, 6> spellings{{{"image_width", "width", "width"},
                                              {"image_height", "height", "height"},
                                              {"camera_matrix", "K", "k"},
                                              {"distortion_coefficients", "D", "d"},
                                              {"rectification_matrix", "R", "r"},
                                              {"projection_matrix", "P", "p"}}};

/// One camera_info: a file, or a message as text.
class CameraInfo {
public:
    explicit CameraInfo(const CalibrationText& file) : path_(file.path) {
        for (const auto& item : read_yaml_map(file.path, file.text, "YAML file")) {
            const std::string name = word_of(item.first);
            const auto known = std::find_if(spellings.begin(), spellings.end(), [&](const Spellings& key) {
                return name == key.file || name == key.ros1 || name == key.ros2;
            });
            if (known == spellings.end()) {
                check_other(name, item.second);
            }
            const std::string key(known == spellings.end() ? name : known->file);
            if (!entries_.emplace(key, Entry{name, item.second}).second) {
                fail(entries_.at(key).name + " and " + name +
                     " are two names of the same; once is allowed: take the wrong one out");
            }
        }
    }

    /// Returns how the file spells a key.
    std::string spelled(const std::string& key) const {
        const auto found = entries_.find(key);
        return found == entries_.end() ? key : found->second.name;
    }

    int integer(const char* key) const {
        const auto number = base::parse_number(text(key).value_or(""));
        if (!number || *number < 1 || *number > 65535 || *number != static_cast<int>(*number)) {
            fail(spelled(key) + ": found '" + base::printable(text(key).value_or("")) +
                 "', expected a number of pixels");
        }
        return static_cast<int>(*number);
    }

    /// Returns the numbers of a matrix; `count` 0 = as many as there are.
    std::vector<double> matrix(const char* key, std::size_t count) const {
        const YAML::Node entry = node(key);
        const YAML::Node data = entry.IsMap() ? entry["data"] : entry;
        if (!data || !data.IsSequence() || (count != 0 && data.size() != count)) {
            fail(spelled(key) + ": has no data of " + (count == 0 ? "numbers" : base::counted(count, "number")) +
                 (data && data.IsSequence() ? ", found " + std::to_string(data.size()) : ""));
        }
        const auto side = [&](const char* name) {
            return base::parse_number(entry.IsMap() ? word_of(entry[name]) : std::string());
        };
        if (const auto rows = side("rows"), columns = side("cols");
            rows && columns && *rows * *columns != static_cast<double>(data.size())) {
            fail(spelled(key) + ": found " + base::number_text(*rows) + " rows and " + base::number_text(*columns) +
                 " columns, and " + base::counted(data.size(), "number") + ": they contradict each other");
        }
        std::vector<double> numbers;
        for (const YAML::Node& item : data) {
            const auto number = base::parse_number(word_of(item));
            if (!number) {
                fail(spelled(key) + ": found '" + base::printable(word_of(item)) + "', expected a number");
            }
            numbers.push_back(*number);
        }
        return numbers;
    }

    /// Refuses a message of a part of the image. 0 x 0 means all of it, too.
    void check_region(int width, int height) const {
        for (const auto& [side, whole] :
             {std::pair("x_offset", 0), {"y_offset", 0}, {"width", width}, {"height", height}}) {
            const YAML::Node roi = node("roi");
            const auto found = base::parse_number(roi.IsMap() ? word_of(roi[side]) : std::string()).value_or(0);
            if (found != 0 && found != whole) {
                fail(std::string("roi ") + side + ": found " + base::number_text(found) + ", expected 0" +
                     (whole == 0 ? "" : " or " + std::to_string(whole)) + ": give the calibration of whole images");
            }
        }
    }

    std::optional<std::string> text(const char* key) const {
        return entries_.contains(key) ? std::optional(word_of(node(key))) : std::nullopt;
    }

    const std::string& path() const { return path_; }

    [[noreturn]] void fail(const std::string& what) const { refuse_calibration(path_, what); }

private:
    struct Entry {
        std::string name;  ///< as the file spells it
        YAML::Node node;
    };

    YAML::Node node(const char* key) const {
        const auto found = entries_.find(key);
        return found == entries_.end() ? YAML::Node() : found->second.node;
    }

    /// Refuses keys that are not known, and messages of images that are made smaller.
    void check_other(const std::string& name, const YAML::Node& value) const {
        const auto number = [](const YAML::Node& node) { return base::parse_number(word_of(node)).value_or(0); };
        if (name.starts_with("binning_")) {
            if (number(value) > 1) {
                fail(name + ": found " + word_of(value) + ", expected 0 or 1: give the calibration of whole images");
            }
        } else if (name != "header" && name != "roi" && name != "camera_name" && name != "distortion_model" &&
                   name != "camera_model") {
            fail("has the key '" + base::printable(name) +
                 "', which is not known and would not be applied; allowed are image_width, image_height, "
                 "camera_name, camera_matrix, distortion_model, distortion_coefficients, rectification_matrix and "
                 "projection_matrix: take it out if it says nothing about lens and size");
        }
    }

    std::string path_;
    std::map<std::string, Entry, std::less<>> entries_;
};

CameraModel camera_of(const CameraInfo& file, std::optional<LensModel> lens) {
    for (const char* key : {"camera_model", "distortion_model"}) {
        const auto name = file.text(key);
        const LensModel named = name ? named_lens(file.path(), key, *name) : LensModel::pinhole;
        // "pinhole" as the camera's model says nothing about the lens's distortion.
        if (name && (std::string_view(key) == "distortion_model" || named == LensModel::fisheye)) {
            lens = named;
        }
    }
    CameraModel camera = camera_of_matrix(file.path(), file.spelled("camera_matrix"), file.matrix("camera_matrix", 9));
    const auto d = file.matrix("distortion_coefficients", 0);
    set_lens(camera, file.path(), file.spelled("distortion_coefficients"), d, lens.value_or(LensModel::pinhole));
    if (!lens && d.size() == 4 && camera.distortion != CameraModel{}.distortion) {
        file.fail(file.spelled("distortion_coefficients") +
                  ": found 4 coefficients and no distortion_model: they may be Brown's (k1 k2 p1 "
                  "p2) or a fisheye's: write 'distortion_model: plumb_bob' into the file if they are Brown's, else "
                  "'distortion_model: equidistant'");
    }
    return camera;
}

void check_size(const CameraInfo& file, int width, int height) {
    const int found_width = file.integer("image_width");
    const int found_height = file.integer("image_height");
    if (found_width != width || found_height != height) {
        refuse_other_size(file.path(), std::to_string(found_width) + "x" + std::to_string(found_height), width, height);
    }
    file.check_region(width, height);
}

/// Tells files of single cameras, and files in the wrong order.
void check_shifts(const EyeProjection& left, const EyeProjection& right) {
    const double left_shift = left.matrix[3];
    const double right_shift = right.matrix[3];
    if (left_shift == right_shift) {
        refuse_calibration(
            right.path, right.key + ": found Tx " + base::number_text(right_shift) + " (row 1, column 4) here and in " +
                            base::printable(left.path, 200) +
                            ": these are the calibrations of two single cameras, or twice the same one, and how the "
                            "right one stands to the left one is missing: calibrate both together, as disparityctl "
                            "calibrate does");
    }
    if (right_shift > left_shift) {
        refuse_calibration(right.path,
                           right.key + ": found Tx " + base::number_text(right_shift) + ", and " +
                               base::number_text(left_shift) + " in " + base::printable(left.path, 200) +
                               ": the right camera's is the smaller one, -f B: exchange the two files, left "
                               "first: " +
                               base::printable(right.path, 200) + "," + base::printable(left.path, 200));
    }
}

}  // namespace

FileCalibration read_ros_calibration(const CalibrationText& left, const CalibrationText& right, int width, int height,
                                     std::optional<LensModel> lens) {
    const CameraInfo left_file(left);
    const CameraInfo right_file(right);
    check_size(left_file, width, height);
    check_size(right_file, width, height);
    FileCalibration result;
    result.unit_mm = metre_mm;
    StereoCalibration& calibration = result.calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.left = camera_of(left_file, lens);
    calibration.right = camera_of(right_file, lens);

    // camera_info holds the rotations to the rectified frame, and in the projections where each eye stands, in metres:
    // X_rect = R1 X_left + (Tx1 / f, 0, 0) and X_rect = R2 X_right + (Tx2 / f, 0, 0) as seen from one and the same
    // point, so that the baseline is the difference of both.
    const cv::Matx33d left_turn(left_file.matrix("rectification_matrix", 9).data());
    const cv::Matx33d right_turn(right_file.matrix("rectification_matrix", 9).data());
    const auto projection = [](const CameraInfo& file) {
        return EyeProjection{file.path(), file.spelled("projection_matrix"), file.matrix("projection_matrix", 12)};
    };
    const EyeProjection left_eye = projection(left_file);
    const EyeProjection right_eye = projection(right_file);
    check_shifts(left_eye, right_eye);
    const double shift = metre_mm * rectified_eyes(left_eye, right_eye, width, height).shift;
    const cv::Matx33d rotation = right_turn.t() * left_turn;
    const cv::Vec3d translation = right_turn.t() * cv::Vec3d(shift, 0, 0);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(translation.val, translation.val + 3, calibration.translation.begin());
    return result;
}

}  // namespace disparityd::calibration
