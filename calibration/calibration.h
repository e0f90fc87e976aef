// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "calibration/inertial_calibration.h"

namespace disparityd::calibration {

/// How a lens takes rays to the image.
enum class LensModel {
    pinhole,  ///< Brown's model, and what widens it: rational, thin prisms, tilted sensor
    fisheye,  ///< equidistant (Kannala-Brandt)
};

/// One camera, pixels. Coefficients stand in OpenCV's order: of a pinhole k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x
/// tau_y, of a fisheye k1 k2 k3 k4; the others are 0.
struct CameraModel {
    double fx = 0;
    double fy = 0;
    double cx = 0;
    double cy = 0;
    std::array<double, 14> distortion{};
    LensModel lens = LensModel::pinhole;
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
    InertialCalibration inertial;  ///< of the inertial sensor beside them
    std::string origin;            ///< where it was read from, for messages: a file name, "recording", "scene"
};

/// The two pairs of cameras that a KITTI calibration may hold.
enum class KittiPair { grey, colour };

/// Reads a calibration for frames of width x height per eye: one file, or two with a comma between them, and behind
/// them, with a comma, one about the inertial sensor (Kalibr's imu.yaml, EuRoC's imu0/sensor.yaml). Formats: a
/// factory .conf; OpenCV's YAML, JSON or XML (M1 D1 M2 D2 R T, or K_LEFT ... of the vendor's own tool; R and T may
/// stand in a second file); a pair of ROS camera_info; settings of ORB-SLAM; Kalibr's camchain; a pair of EuRoC's
/// sensor.yaml; calib.txt of Middlebury, ETH3D and KITTI. docs/calibration.md lists the keys. Behind a question mark
/// stands what the files leave open, as in "stereo.yml?unit=m": unit=mm, cm, m or the side of the board's squares as
/// 25mm; model=brown or fisheye; pair=grey or colour. `pair` is which of KITTI's pairs the frames are of, where the
/// caller knows. Throws std::invalid_argument with one line: file, key, what was found, what is allowed.
StereoCalibration read_calibration(const std::string& path, int width, int height,
                                   std::optional<KittiPair> pair = std::nullopt);

/// Returns the calibration of the same cameras in another mode, whose images show the same part of the sensor at
/// another size. Throws std::invalid_argument with one line when width and height have another ratio: such a mode shows
/// another part, or is stretched.
StereoCalibration scaled(const StereoCalibration& calibration, int width, int height);

/// Writes the calibration of two raw cameras as OpenCV's YAML (M1 D1 M2 D2 R T, T in mm), which read_calibration() and
/// OpenCV read back without loss. What is known of the inertial sensor stands there, too: T_cam_imu as a matrix of 4x4,
/// in mm as T, and the numbers under the names of inertial_numbers. The same calibration gives the same text.
std::string to_opencv_yaml(const StereoCalibration& calibration);

/// Writes the calibration as the text that recordings hold, without loss.
std::string to_text(const StereoCalibration& calibration);
/// Reads the text of to_text(); `origin` is for messages. Throws std::invalid_argument when the text is damaged.
StereoCalibration calibration_from_text(const std::string& text, const std::string& origin);

}  // namespace disparityd::calibration
