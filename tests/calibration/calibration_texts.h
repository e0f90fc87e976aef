// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/calibration/calibration_rigs.h"

/// A rig as the text of every format.
namespace disparityd::calibration::test {

inline std::string list_of(const cv::Mat& matrix) {
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < static_cast<int>(matrix.total()); ++i) {
        text << (i == 0 ? "" : ", ") << matrix.at<double>(i / matrix.cols, i % matrix.cols);
    }
    return text.str();
}

inline std::string matrix_text(const std::string& name, const cv::Mat& matrix) {
    return name + ":\n  rows: " + std::to_string(matrix.rows) + "\n  cols: " + std::to_string(matrix.cols) +
           "\n  dt: d\n  data: [ " + list_of(matrix) + " ]\n";
}

inline cv::Mat row(std::span<const double> distortion) {
    return cv::Mat(1, static_cast<int>(distortion.size()), CV_64F, const_cast<double*>(distortion.data())).clone();
}

inline std::string with_other(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline std::string size_lines(const Rig& rig) {
    return "image_width: " + std::to_string(rig.width) + "\nimage_height: " + std::to_string(rig.height) + "\n";
}

/// M1 D1 M2 D2 R T without a first line.
inline std::string opencv_text(const Rig& rig, double unit = 1) {
    return size_lines(rig) + matrix_text("M1", cv::Mat(rig.left_matrix())) +
           matrix_text("D1", row(rig.left_distortion)) + matrix_text("M2", cv::Mat(rig.right_matrix())) +
           matrix_text("D2", row(rig.right_distortion)) + matrix_text("R", cv::Mat(rig.rotation())) +
           matrix_text("T", cv::Mat(rig.translation * (1 / unit)));
}

/// The names are the vendor's.
inline void put_by_opencv(const Rig& rig, cv::FileStorage& file) {
    file << "Size" << cv::Size(rig.width, rig.height) << "K_LEFT" << cv::Mat(rig.left_matrix()) << "K_RIGHT"
         << cv::Mat(rig.right_matrix()) << "D_LEFT" << row(rig.left_distortion) << "D_RIGHT"
         << row(rig.right_distortion) << "R" << cv::Mat(rig.turn) << "T" << cv::Mat(rig.translation);
}

/// As OpenCV itself writes it; the ending of `path` says whether as YAML, JSON or XML.
inline void write_by_opencv(const Rig& rig, const std::string& path) {
    cv::FileStorage file(path, cv::FileStorage::WRITE);
    put_by_opencv(rig, file);
}

/// One eye's camera_info. `shift` is Tx / f in mm.
inline std::string ros_text(const Rig& rig, int eye, double shift) {
    const Rectified rectified(rig);
    cv::Mat projection = rectified.projection[0].clone();
    projection.at<double>(0, 3) = rectified.f() * shift / 1000;
    return size_lines(rig) + "camera_name: eye\n" +
           matrix_text("camera_matrix", cv::Mat(eye == 0 ? rig.left_matrix() : rig.right_matrix())) +
           "distortion_model: plumb_bob\n" +
           matrix_text("distortion_coefficients", row(eye == 0 ? rig.left_distortion : rig.right_distortion)) +
           matrix_text("rectification_matrix", rectified.turn[eye]) + matrix_text("projection_matrix", projection);
}

/// The same as `rostopic echo` prints it; as ROS 2 does in lower case. `more` are further lines.
inline std::string ros_message(const Rig& rig, int eye, double shift, bool lower_case, const std::string& more = "") {
    const Rectified rectified(rig);
    cv::Mat projection = rectified.projection[0].clone();
    projection.at<double>(0, 3) = rectified.f() * shift / 1000;
    const auto line = [&](const char* upper, const char* lower, const cv::Mat& matrix) {
        return std::string(lower_case ? lower : upper) + ": [" + list_of(matrix) + "]\n";
    };
    return "header:\n  frame_id: eye\nheight: " + std::to_string(rig.height) + "\nwidth: " + std::to_string(rig.width) +
           "\ndistortion_model: plumb_bob\n" +
           line("D", "d", row(eye == 0 ? rig.left_distortion : rig.right_distortion)) +
           line("K", "k", cv::Mat(eye == 0 ? rig.left_matrix() : rig.right_matrix())) +
           line("R", "r", rectified.turn[eye]) + line("P", "p", projection) + more + "---\n";
}

/// Lists of rows, as Python writes them, in JSON or in YAML.
inline std::string python_text(const Rig& rig, bool json) {
    const auto entry = [&](const char* name, const cv::Mat& matrix) {
        std::string rows;
        for (int y = 0; y < matrix.rows; ++y) {
            rows += json ? (y == 0 ? "[" : ", [") : "- [";
            rows += list_of(matrix.row(y)) + (json ? "]" : "]\n");
        }
        return json ? ", \"" + std::string(name) + "\": [" + rows + "]" : std::string(name) + ":\n" + rows;
    };
    const std::string matrices =
        entry("cameraMatrix1", cv::Mat(rig.left_matrix())) + entry("distCoeffs1", row(rig.left_distortion)) +
        entry("cameraMatrix2", cv::Mat(rig.right_matrix())) + entry("distCoeffs2", row(rig.right_distortion)) +
        entry("R", cv::Mat(rig.rotation())) + entry("T", cv::Mat(rig.translation));
    const std::string size = "[" + std::to_string(rig.width) + ", " + std::to_string(rig.height) + "]";
    return json ? "{\"image_size\": " + size + matrices + "}\n" : "image_size: " + size + "\n" + matrices;
}

inline std::string orbslam_2(const Rig& rig) {
    const Rectified rectified(rig);
    std::string text = "%YAML:1.0\n\nCamera.width: " + std::to_string(rig.width) +
                       "\nCamera.height: " + std::to_string(rig.height) + "\nORBextractor.nFeatures: 1200\n";
    for (const int eye : {0, 1}) {
        const std::string name = eye == 0 ? "LEFT." : "RIGHT.";
        cv::Mat projection = rectified.projection[eye].clone();
        projection.at<double>(0, 3) /= 1000;
        text += matrix_text(name + "K", cv::Mat(eye == 0 ? rig.left_matrix() : rig.right_matrix())) +
                matrix_text(name + "D", row(eye == 0 ? rig.left_distortion : rig.right_distortion)) +
                matrix_text(name + "R", rectified.turn[eye]) + matrix_text(name + "P", projection);
    }
    return text;
}

inline std::string orbslam_3(const Rig& rig) {
    std::ostringstream text;
    text.precision(17);
    text << "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera.width: " << rig.width
         << "\nCamera.height: " << rig.height << "\nStereo.ThDepth: 60.0\n";
    for (const int eye : {1, 2}) {
        const auto& camera = eye == 1 ? rig.left : rig.right;
        const auto& k = eye == 1 ? rig.left_distortion : rig.right_distortion;
        const std::string name = "Camera" + std::to_string(eye) + ".";
        text << name << "fx: " << camera[0] << "\n"
             << name << "fy: " << camera[1] << "\n"
             << name << "cx: " << camera[2] << "\n"
             << name << "cy: " << camera[3] << "\n"
             << name << "k1: " << k[0] << "\n"
             << name << "k2: " << k[1] << "\n"
             << name << "p1: " << k[2] << "\n"
             << name << "p2: " << k[3] << "\n"
             << name << "k3: " << k[4] << "\n";
    }
    // The pose of the right camera as the left one sees it: the inverse of ours.
    const cv::Matx33d back = rig.rotation().t();
    const cv::Vec3d centre = back * rig.translation * (-1 / 1000.0);
    const cv::Mat pose = (cv::Mat_<double>(4, 4) << back(0, 0), back(0, 1), back(0, 2), centre[0], back(1, 0),
                          back(1, 1), back(1, 2), centre[1], back(2, 0), back(2, 1), back(2, 2), centre[2], 0, 0, 0, 1);
    return text.str() + matrix_text("Stereo.T_c1_c2", pose);
}

/// sensor.yaml of one eye, on a body whose axes are others. It has four coefficients.
inline std::string euroc_sensor(const Rig& rig, int eye) {
    cv::Matx33d turn;
    cv::Rodrigues(cv::Vec3d(0.02, -0.01, 1.55), turn);
    cv::Vec3d at(-0.0216, -0.0647, 0.0098);
    if (eye == 1) {
        turn = turn * rig.rotation().t();
        at -= turn * rig.translation * (1 / 1000.0);
    }
    const auto& camera = eye == 0 ? rig.left : rig.right;
    const auto& k = eye == 0 ? rig.left_distortion : rig.right_distortion;
    std::ostringstream text;
    text.precision(17);
    text << "%YAML:1.0\nsensor_type: camera\ncomment: made\nT_BS:\n  cols: 4\n  rows: 4\n  data: [";
    for (int i = 0; i < 3; ++i) {
        text << turn(i, 0) << ", " << turn(i, 1) << ", " << turn(i, 2) << ", " << at[i] << ",\n    ";
    }
    text << "0, 0, 0, 1]\nrate_hz: 20\nresolution: [" << rig.width << ", " << rig.height
         << "]\ncamera_model: pinhole\nintrinsics: [" << camera[0] << ", " << camera[1] << ", " << camera[2] << ", "
         << camera[3] << "] #fu, fv, cu, cv\ndistortion_model: radial-tangential\ndistortion_coefficients: [" << k[0]
         << ", " << k[1] << ", " << k[2] << ", " << k[3] << "]\n";
    return text.str();
}

/// Kalibr has four coefficients.
inline std::string camchain(const Rig& rig) {
    std::ostringstream text;
    text.precision(17);
    const cv::Matx33d r = rig.rotation();
    const cv::Vec3d t = rig.translation * (1 / 1000.0);
    for (const int eye : {0, 1}) {
        const auto& camera = eye == 0 ? rig.left : rig.right;
        const auto& k = eye == 0 ? rig.left_distortion : rig.right_distortion;
        text << "cam" << eye << ":\n";
        for (int i = 0; eye == 1 && i < 3; ++i) {
            text << (i == 0 ? "  T_cn_cnm1:\n" : "") << "  - [" << r(i, 0) << ", " << r(i, 1) << ", " << r(i, 2) << ", "
                 << t[i] << "]\n";
        }
        text << (eye == 1 ? "  - [0.0, 0.0, 0.0, 1.0]\n" : "") << "  cam_overlaps: [" << 1 - eye
             << "]\n  camera_model: pinhole\n  distortion_coeffs: [" << k[0] << ", " << k[1] << ", " << k[2] << ", "
             << k[3] << "]\n  distortion_model: radtan\n  intrinsics: [" << camera[0] << ", " << camera[1] << ", "
             << camera[2] << ", " << camera[3] << "]\n  resolution: [" << rig.width << ", " << rig.height
             << "]\n  rostopic: /camera/image_raw\n";
    }
    return text.str();
}

}  // namespace disparityd::calibration::test
