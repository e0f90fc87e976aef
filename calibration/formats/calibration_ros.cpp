// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string>

#include <opencv2/core/matx.hpp>
#include <yaml-cpp/yaml.h>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

namespace {

// One camera_info file.
class CameraInfo {
public:
    explicit CameraInfo(const std::string& path) : path_(path) {
        try {
            root_ = YAML::Load(base::read_text_file(path, "calibration"));
        } catch (const YAML::Exception& error) {
            fail("line " + std::to_string(error.mark.line + 1) + ": is no YAML");
        }
        if (!root_.IsMap()) {
            fail("is no camera_info: image_width, camera_matrix and others are expected");
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

    std::vector<double> matrix(const char* key, std::size_t least) const {
        const YAML::Node entry = root_[key];
        const YAML::Node data = entry && entry.IsMap() ? entry["data"] : YAML::Node();
        if (!data || !data.IsSequence() || data.size() < least) {
            fail(std::string(key) + ": has no data of " + std::to_string(least) + " numbers");
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

    std::string text(const char* key) const { return root_[key] ? scalar(root_[key], key) : std::string(); }

    const std::string& path() const { return path_; }

    [[noreturn]] void fail(const std::string& what) const {
        throw std::invalid_argument("calibration " + path_ + ": " + what);
    }

private:
    std::string scalar(const YAML::Node& node, const char* key) const {
        if (!node || !node.IsScalar()) {
            fail(std::string("has no ") + key);
        }
        return node.Scalar();
    }

    std::string path_;
    YAML::Node root_;
};

CameraModel camera_of(const CameraInfo& file) {
    const std::string model = file.text("distortion_model");
    if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial") {
        file.fail("distortion_model: found '" + base::printable(model) + "', allowed is plumb_bob");
    }
    const auto k = file.matrix("camera_matrix", 9);
    CameraModel camera{k[0], k[4], k[2], k[5], {}};
    const auto d = file.matrix("distortion_coefficients", 0);
    for (std::size_t i = 0; i < d.size(); ++i) {
        if (i < camera.distortion.size()) {
            camera.distortion[i] = d[i];
        } else if (d[i] != 0) {
            file.fail("distortion_coefficients: found more than five, allowed is the plumb_bob model");
        }
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

}  // namespace

StereoCalibration read_ros_calibration(const std::string& left, const std::string& right, int width, int height) {
    const CameraInfo left_file(left);
    const CameraInfo right_file(right);
    check_size(left_file, width, height);
    check_size(right_file, width, height);
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.origin = left + "," + right;
    calibration.left = camera_of(left_file);
    calibration.right = camera_of(right_file);

    // camera_info holds the rotations to the rectified frame, and the baseline in metres in the right projection:
    // X_rect = R1 X_left and X_rect + (Tx, 0, 0) = R2 X_right.
    const cv::Matx33d left_turn(left_file.matrix("rectification_matrix", 9).data());
    const cv::Matx33d right_turn(right_file.matrix("rectification_matrix", 9).data());
    const auto projection = right_file.matrix("projection_matrix", 12);
    if (projection[0] == 0) {
        right_file.fail("projection_matrix: focal length 0");
    }
    const cv::Matx33d rotation = right_turn.t() * left_turn;
    const cv::Vec3d translation = right_turn.t() * cv::Vec3d(1000 * projection[3] / projection[0], 0, 0);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    std::copy(translation.val, translation.val + 3, calibration.translation.begin());
    return calibration;
}

}  // namespace disparityd::calibration
