// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace disparityd::calibration {

/// One camera: pinhole with Brown distortion, OpenCV's order of coefficients (k1 k2 p1 p2 k3), pixels.
struct CameraModel {
    double fx = 0;
    double fy = 0;
    double cx = 0;
    double cy = 0;
    std::array<double, 5> distortion{};
};

/// The calibration of a stereo pair for one capture size, as OpenCV's stereoRectify takes it.
struct StereoCalibration {
    int width = 0;  ///< one eye, pixels; the size that the camera models are valid for
    int height = 0;
    CameraModel left;
    CameraModel right;
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major, left to right camera
    std::array<double, 3> translation{};                        ///< mm; (-baseline, ty, tz)
    /// The images are rectified already: no distortion, no rotation; the principal points may differ in x, which
    /// gives a disparity offset (Middlebury's doffs). baseline 0 = not known: no metric depth.
    bool rectified = false;
    std::string origin;  ///< where it was read from, for messages: a file name, "recording", "scene"
};

/// Reads a calibration file for frames of width x height per eye: a factory .conf, OpenCV YAML/XML (keys M1 D1 M2 D2
/// R T, or two files intrinsics/extrinsics joined), a ROS camera_info pair given as "left.yaml,right.yaml", or the
/// calib.txt of a Middlebury (2014) or KITTI scene.
/// Throws std::invalid_argument with one line: file, key, what was found, what is allowed.
StereoCalibration read_calibration(const std::string& path, int width, int height);

/// Writes the calibration of two raw cameras as OpenCV's YAML (M1 D1 M2 D2 R T, T in mm), which read_calibration() and
/// OpenCV read back without loss. The same calibration gives the same text.
std::string to_opencv_yaml(const StereoCalibration& calibration);

/// Writes the calibration as the text that recordings hold, without loss.
std::string to_text(const StereoCalibration& calibration);
/// Reads the text of to_text(); `origin` is for messages. Throws std::invalid_argument when the text is damaged.
StereoCalibration calibration_from_text(const std::string& text, const std::string& origin);

}  // namespace disparityd::calibration
