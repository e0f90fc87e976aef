// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/pose_agreement.h"
#include "calibration/formats/yaml_numbers.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

namespace {

/// cam0 or cam1 of the file.
class ChainCamera {
public:
    ChainCamera(const std::string& path, const std::string& name, const YAML::Node& node)
        : path_(path), name_(name), node_(node) {
        if (!node_ || !node_.IsMap()) {
            fail("", "is missing; cam0 and cam1 are needed");
        }
        constexpr std::array<std::string_view, 10> known{
            "T_cn_cnm1",        "T_cam_imu",  "cam_overlaps", "camera_model", "distortion_coeffs",
            "distortion_model", "intrinsics", "resolution",   "rostopic",     "timeshift_cam_imu"};
        for (const auto& item : node_) {
            const std::string key = word_of(item.first);
            if (std::find(known.begin(), known.end(), key) == known.end()) {
                fail(base::printable(key),
                     "is a key that is not known and would not be applied: take it out if it "
                     "says nothing about lens and size");
            }
        }
    }

    bool has(const char* key) const { return node_[key].IsDefined(); }

    CameraModel model() const {
        named_model("camera_model");
        const auto intrinsics = numbers("intrinsics", node_["intrinsics"], 4);
        CameraModel camera{intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], {}};
        set_lens(camera, path_, name_ + " distortion_coeffs",
                 numbers("distortion_coeffs", node_["distortion_coeffs"], 0), named_model("distortion_model"));
        return camera;
    }

    void check_size(int width, int height) const {
        const auto size = numbers("resolution", node_["resolution"], 2);
        if (size[0] != width || size[1] != height) {
            refuse_other_size(
                path_, base::number_text(size[0]) + "x" + base::number_text(size[1]) + " (" + name_ + " resolution)",
                width, height);
        }
    }

    /// Returns the pose of the inertial sensor, in mm, where the file has it.
    std::optional<Pose> inertial_pose() const {
        if (!has("T_cam_imu")) {
            return std::nullopt;
        }
        return pose_of_metres(yaml_pose(path_, name_ + " T_cam_imu", node_["T_cam_imu"]));
    }

    std::optional<double> time_offset_s() const {
        if (!has("timeshift_cam_imu")) {
            return std::nullopt;
        }
        return yaml_number(path_, name_ + " timeshift_cam_imu", node_["timeshift_cam_imu"]);
    }

    cv::Matx44d pose(const char* key) const {
        const YAML::Node rows = node_[key];
        if (!rows || !rows.IsSequence() || rows.size() != 4) {
            fail(key, "expected a matrix of 4x4");
        }
        cv::Matx44d pose;
        for (std::size_t row = 0; row < 4; ++row) {
            const auto values = numbers(key, rows[row], 4);
            std::copy(values.begin(), values.end(), pose.val + 4 * row);
        }
        return pose;
    }

private:
    [[noreturn]] void fail(const std::string& key, const std::string& what) const {
        refuse_calibration(path_, name_ + (key.empty() ? " " : " " + key + ": ") + what);
    }

    LensModel named_model(const char* key) const {
        if (!has(key)) {
            fail(key, "is missing; pinhole with radtan or equidistant is allowed");
        }
        return named_lens(path_, name_ + " " + key, word_of(node_[key]));
    }

    std::vector<double> numbers(const char* key, const YAML::Node& list, std::size_t count) const {
        return yaml_numbers(path_, name_ + " " + key, list, count);
    }

    std::string path_;
    std::string name_;
    const YAML::Node node_;
};

/// Compares the pose of the right camera with those of both cameras to the IMU, where the file has them.
void check_imu_poses(const std::string& path, const ChainCamera& left, const ChainCamera& right,
                     const StereoCalibration& cameras) {
    const auto to_left = left.inertial_pose();
    const auto to_right = right.inertial_pose();
    if (!to_left || !to_right) {
        return;
    }
    const Pose by_imu = chained(inverse(*to_left), *to_right);
    const double degrees = degrees_between(cv::Matx33d(by_imu.rotation.data()), cv::Matx33d(cameras.rotation.data()));
    const cv::Vec3d stated(cameras.translation.data());
    const double distance = cv::norm(cv::Vec3d(by_imu.translation.data()) - stated);
    if (!(degrees <= largest_turn_degrees) || !(distance <= largest_baseline_share * cv::norm(stated))) {
        refuse_calibration(path, "cam1 T_cn_cnm1: found a pose that differs by " + degrees_text(degrees) + " and " +
                                     base::number_text(std::round(1e3 * distance) / 1e3) +
                                     " mm from the one that T_cam_imu of cam0 and cam1 give, expected at most " +
                                     degrees_text(largest_turn_degrees) +
                                     " and 1 % of the baseline: they contradict each other; take the wrong ones out");
    }
}

/// Returns where the sensor stands to the left camera, also where the file says it of the right one alone.
InertialCalibration inertial_of(const StereoCalibration& cameras, const ChainCamera& left, const ChainCamera& right) {
    InertialCalibration inertial;
    inertial.to_left_camera = left.inertial_pose();
    if (const auto to_right = right.inertial_pose(); to_right && !inertial.to_left_camera) {
        inertial.to_left_camera = chained(*to_right, inverse({cameras.rotation, cameras.translation}));
    }
    // Kalibr finds an offset for each camera; those of eyes that are exposed together differ by what it cannot tell.
    inertial.time_offset_s = left.has("timeshift_cam_imu") ? left.time_offset_s() : right.time_offset_s();
    return inertial;
}

}  // namespace

FileCalibration read_kalibr_camchain(const CalibrationText& file, int width, int height) {
    const YAML::Node root = read_yaml_map(file.path, file.text, "YAML file");
    for (const auto& item : root) {
        const std::string name = word_of(item.first);
        if (name != "cam0" && name != "cam1") {
            refuse_calibration(file.path, "has the entry '" + base::printable(name) +
                                              "' beside cam0 and cam1; allowed is a chain of two cameras, the left one "
                                              "first");
        }
    }
    const ChainCamera left(file.path, "cam0", root["cam0"]);
    if (!root["cam1"]) {
        refuse_calibration(file.path,
                           "is the calibration of one camera, cam0: cam1 with T_cn_cnm1 is needed, too: "
                           "calibrate both together");
    }
    const ChainCamera right(file.path, "cam1", root["cam1"]);
    left.check_size(width, height);
    right.check_size(width, height);
    FileCalibration result;
    result.unit_mm = metre_mm;
    result.calibration.width = width;
    result.calibration.height = height;
    result.calibration.left = left.model();
    result.calibration.right = right.model();
    if (!right.has("T_cn_cnm1")) {
        refuse_calibration(file.path, "cam1 has no T_cn_cnm1, the pose that takes points of cam0 to cam1");
    }
    const cv::Matx44d pose = right.pose("T_cn_cnm1");
    for (std::size_t row = 0; row < 3; ++row) {
        std::copy(pose.val + 4 * row, pose.val + 4 * row + 3, result.calibration.rotation.begin() + 3 * row);
        result.calibration.translation[row] = metre_mm * pose.val[4 * row + 3];
    }
    check_imu_poses(file.path, left, right, result.calibration);
    result.calibration.inertial = inertial_of(result.calibration, left, right);
    return result;
}

}  // namespace disparityd::calibration
