// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>
#include <string>

#include "base/text_file.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/opencv_storage.h"

namespace disparityd::calibration {

namespace {

using Matrix = OpencvStorage::Matrix;

// OpenCV's own programs and users give the same matrix several names.
using Names = std::initializer_list<const char*>;

class CalibrationFile {
public:
    explicit CalibrationFile(const std::string& path)
        : path_(path), storage_(path, base::read_text_file(path, "calibration")) {}

    Matrix matrix(Names names) const {
        for (const char* name : names) {
            if (const auto matrix = storage_.matrix(name)) {
                return *matrix;
            }
        }
        fail("has no matrix " + std::string(*names.begin()) +
             "; M1, D1, M2, D2, R and T are needed, in one file or as intrinsics.yml,extrinsics.yml");
    }

    void check_size(int width, int height) const {
        for (const auto& [width_key, height_key] :
             {std::pair("image_width", "image_height"), std::pair("imageWidth", "imageHeight")}) {
            const auto found_width = storage_.integer(width_key);
            const auto found_height = storage_.integer(height_key);
            if (found_width && found_height && (*found_width != width || *found_height != height)) {
                refuse_other_size(path_, std::to_string(*found_width) + "x" + std::to_string(*found_height), width,
                                  height);
            }
        }
    }

    [[noreturn]] void fail(const std::string& what) const { storage_.fail(what); }

private:
    std::string path_;
    OpencvStorage storage_;
};

std::string size_text(const Matrix& matrix) {
    return std::to_string(matrix.rows) + "x" + std::to_string(matrix.columns);
}

CameraModel camera_of(const CalibrationFile& file, const Matrix& matrix, const Matrix& distortion,
                      const std::string& names) {
    if (matrix.rows != 3 || matrix.columns != 3) {
        file.fail(names + ": found a camera matrix of " + size_text(matrix) + ", expected 3x3");
    }
    const auto& m = matrix.numbers;
    CameraModel camera{m[0], m[4], m[2], m[5], {}};
    const auto& k = distortion.numbers;
    for (std::size_t i = 0; i < k.size(); ++i) {
        if (i < camera.distortion.size()) {
            camera.distortion[i] = k[i];
        } else if (k[i] != 0) {
            file.fail(names + ": found " + std::to_string(k.size()) +
                      " distortion coefficients, allowed are the five of the Brown model (k1 k2 p1 p2 k3): calibrate "
                      "without the rational model");
        }
    }
    return camera;
}

}  // namespace

StereoCalibration read_opencv_calibration(const std::string& path, const std::string& extrinsics, int width,
                                          int height) {
    const CalibrationFile intrinsic_file(path);
    const CalibrationFile extrinsic_file(extrinsics.empty() ? path : extrinsics);
    intrinsic_file.check_size(width, height);
    extrinsic_file.check_size(width, height);
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.origin = path;
    calibration.left = camera_of(
        intrinsic_file, intrinsic_file.matrix({"M1", "cameraMatrix1", "CM1", "K1", "camera_matrix_1", "LEFT_K"}),
        intrinsic_file.matrix({"D1", "distCoeffs1", "distortion_coefficients_1", "LEFT_D"}), "M1, D1");
    calibration.right = camera_of(
        intrinsic_file, intrinsic_file.matrix({"M2", "cameraMatrix2", "CM2", "K2", "camera_matrix_2", "RIGHT_K"}),
        intrinsic_file.matrix({"D2", "distCoeffs2", "distortion_coefficients_2", "RIGHT_D"}), "M2, D2");
    const Matrix rotation = extrinsic_file.matrix({"R", "rotation"});
    const Matrix translation = extrinsic_file.matrix({"T", "translation"});
    if (rotation.numbers.size() != calibration.rotation.size()) {
        extrinsic_file.fail("R: found " + size_text(rotation) + ", expected a rotation matrix of 3x3");
    }
    if (translation.numbers.size() != calibration.translation.size()) {
        extrinsic_file.fail("T: found " + std::to_string(translation.numbers.size()) + " numbers, expected 3, in mm");
    }
    std::copy(rotation.numbers.begin(), rotation.numbers.end(), calibration.rotation.begin());
    std::copy(translation.numbers.begin(), translation.numbers.end(), calibration.translation.begin());
    return calibration;
}

}  // namespace disparityd::calibration
