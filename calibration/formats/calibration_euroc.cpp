// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/yaml_numbers.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

namespace {

/// sensor.yaml of one camera.
class SensorFile {
public:
    explicit SensorFile(const CalibrationText& file)
        : path_(file.path), root_(read_yaml_map(file.path, file.text, "YAML file")) {
        constexpr std::array<std::string_view, 10> known{"sensor_type",      "comment",
                                                         "camera_id",        "T_BS",
                                                         "rate_hz",          "resolution",
                                                         "camera_model",     "intrinsics",
                                                         "distortion_model", "distortion_coefficients"};
        for (const auto& item : root_) {
            const std::string key = word_of(item.first);
            if (std::find(known.begin(), known.end(), key) == known.end()) {
                fail("has the key '" + base::printable(key) +
                     "', which is not known and would not be applied: take it out if it says nothing about lens and "
                     "size");
            }
        }
        const std::string type = word_of(root_["sensor_type"]);
        if (!type.empty() && type != "camera") {
            fail("sensor_type: found '" + base::printable(type) + "', expected camera");
        }
    }

    CameraModel camera() const {
        named_model("camera_model");
        const auto intrinsics = numbers("intrinsics", 4);
        CameraModel camera{intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], {}};
        set_lens(camera, path_, "distortion_coefficients", numbers("distortion_coefficients", 0),
                 named_model("distortion_model"));
        return camera;
    }

    void check_size(int width, int height) const {
        const auto size = numbers("resolution", 2);
        if (size[0] != width || size[1] != height) {
            refuse_other_size(path_, base::number_text(size[0]) + "x" + base::number_text(size[1]) + " (resolution)",
                              width, height);
        }
    }

    /// Returns T_BS, which takes points of the camera to the body.
    cv::Matx44d to_body() const { return yaml_pose(path_, "T_BS", root_["T_BS"]); }

private:
    [[noreturn]] void fail(const std::string& what) const { refuse_calibration(path_, what); }

    LensModel named_model(const char* key) const {
        if (!root_[key]) {
            fail(std::string(key) + ": is missing; pinhole with radial-tangential or equidistant is allowed");
        }
        return named_lens(path_, key, word_of(root_[key]));
    }

    std::vector<double> numbers(const std::string& key, std::size_t count) const {
        return yaml_numbers(path_, key, root_[key], count);
    }

    std::string path_;
    const YAML::Node root_;
};

}  // namespace

FileCalibration read_euroc_sensors(const CalibrationText& left, const CalibrationText& right, int width, int height) {
    const SensorFile left_file(left);
    const SensorFile right_file(right);
    left_file.check_size(width, height);
    right_file.check_size(width, height);
    FileCalibration result;
    result.unit_mm = metre_mm;
    StereoCalibration& calibration = result.calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.left = left_file.camera();
    calibration.right = right_file.camera();
    const cv::Matx44d left_pose = left_file.to_body();
    const cv::Matx44d right_pose = right_file.to_body();
    result.left_to_body = pose_of_metres(left_pose);
    const cv::Matx33d back = right_pose.get_minor<3, 3>(0, 0).t();
    const cv::Matx33d rotation = back * left_pose.get_minor<3, 3>(0, 0);
    const cv::Matx31d translation = back * (left_pose.get_minor<3, 1>(0, 3) - right_pose.get_minor<3, 1>(0, 3));
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    for (std::size_t i = 0; i < 3; ++i) {
        calibration.translation[i] = metre_mm * translation.val[i];
    }
    return result;
}

}  // namespace disparityd::calibration
