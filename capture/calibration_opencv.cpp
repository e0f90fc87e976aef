// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>

#include "capture/calibration_formats.h"
#include "capture/text_file.h"

namespace disparityd::capture {

namespace {

// The names that OpenCV's own programs and users give the same matrix.
using Names = std::initializer_list<const char*>;

class Storage {
public:
    explicit Storage(const std::string& path) : path_(path) {
        read_text_file(path, "calibration");  // for its messages
        try {
            file_.open(path, cv::FileStorage::READ);
        } catch (const cv::Exception&) {
            file_.release();
        }
        if (!file_.isOpened()) {
            throw std::invalid_argument("calibration " + path + ": is no OpenCV YAML or XML file, or a damaged one");
        }
    }

    cv::Mat matrix(Names names, bool required = true) const {
        for (const char* name : names) {
            cv::Mat matrix;
            try {
                file_[name] >> matrix;
            } catch (const cv::Exception&) {
                throw std::invalid_argument("calibration " + path_ + ": " + name + " is no matrix");
            }
            if (!matrix.empty()) {
                cv::Mat numbers;
                matrix.convertTo(numbers, CV_64F);
                if (!cv::checkRange(numbers)) {
                    throw std::invalid_argument("calibration " + path_ + ": " + name +
                                                " has values that are no numbers");
                }
                return numbers;
            }
        }
        if (required) {
            throw std::invalid_argument("calibration " + path_ + ": has no matrix " + *names.begin() +
                                        "; M1, D1, M2, D2, R and T are needed, in one file or as "
                                        "intrinsics.yml,extrinsics.yml");
        }
        return {};
    }

    void check_size(int width, int height) const {
        for (const auto& [width_key, height_key] :
             {std::pair("image_width", "image_height"), std::pair("imageWidth", "imageHeight")}) {
            const cv::FileNode found_width = file_[width_key];
            const cv::FileNode found_height = file_[height_key];
            if (found_width.isInt() && found_height.isInt() &&
                (static_cast<int>(found_width) != width || static_cast<int>(found_height) != height)) {
                refuse_other_size(path_,
                                  std::to_string(static_cast<int>(found_width)) + "x" +
                                      std::to_string(static_cast<int>(found_height)),
                                  width, height);
            }
        }
    }

    void fail(const std::string& what) const { throw std::invalid_argument("calibration " + path_ + ": " + what); }

private:
    std::string path_;
    cv::FileStorage file_;
};

CameraModel camera_of(const Storage& file, const cv::Mat& matrix, const cv::Mat& distortion, const std::string& names) {
    if (matrix.rows != 3 || matrix.cols != 3) {
        file.fail(names + ": found a camera matrix of " + std::to_string(matrix.rows) + "x" +
                  std::to_string(matrix.cols) + ", expected 3x3");
    }
    CameraModel camera{
        matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2), matrix.at<double>(1, 2), {}};
    const cv::Mat flat = distortion.reshape(1, 1);
    for (int i = 0; i < flat.cols; ++i) {
        const double value = flat.at<double>(0, i);
        if (i < 5) {
            camera.distortion[static_cast<std::size_t>(i)] = value;
        } else if (value != 0) {
            file.fail(names + ": found " + std::to_string(flat.cols) +
                      " distortion coefficients, allowed are the five of the Brown model (k1 k2 p1 p2 k3): calibrate "
                      "without the rational model");
        }
    }
    return camera;
}

}  // namespace

StereoCalibration read_opencv_calibration(const std::string& path, const std::string& extrinsics, int width,
                                          int height) {
    const Storage intrinsic_file(path);
    const Storage extrinsic_file(extrinsics.empty() ? path : extrinsics);
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
    const cv::Mat rotation = extrinsic_file.matrix({"R", "rotation"});
    const cv::Mat translation = extrinsic_file.matrix({"T", "translation"});
    if (rotation.total() != 9) {
        extrinsic_file.fail("R: found " + std::to_string(rotation.rows) + "x" + std::to_string(rotation.cols) +
                            ", expected a rotation matrix of 3x3");
    }
    if (translation.total() != 3) {
        extrinsic_file.fail("T: found " + std::to_string(translation.total()) + " numbers, expected 3, in mm");
    }
    std::copy_n(rotation.ptr<double>(), 9, calibration.rotation.begin());
    std::copy_n(translation.ptr<double>(), 3, calibration.translation.begin());
    return calibration;
}

}  // namespace disparityd::capture
