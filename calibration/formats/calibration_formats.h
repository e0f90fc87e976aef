// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "calibration/formats/given_rectification.h"

/// The file formats behind read_calibration(), one file of code each. All throw std::invalid_argument with one line:
/// file, key, what was found, what is allowed. Keys that a reader neither uses nor knows as harmless are refused;
/// docs/calibration.md lists them.
namespace disparityd::calibration {

inline constexpr double metre_mm = 1000;

/// A file that was read.
struct CalibrationText {
    std::string path;  ///< for messages
    std::string text;
};

/// What a file says, and what it leaves open.
struct FileCalibration {
    StereoCalibration calibration;     ///< translation in mm if the file's unit is `unit_mm`
    double unit_mm = 1;                ///< what one of the file's lengths is, by the rules of the format or by a key
    bool unit_stated = false;          ///< by a key of the file
    double least_baseline_mm = 20;     ///< below this the unit must be stated
    std::string unit_doubt;            ///< why the unit must be stated at any length, as a message says it
    std::optional<Pose> left_to_body;  ///< where the left camera stands on the body that T_BS of EuRoC's files are of
    std::vector<GivenResult> given;    ///< what the file says beside that must agree with it
};

/// Reads a factory file SN<serial>.conf.
StereoCalibration read_factory_conf(const std::string& path, const std::string& text, int width, int height);

/// Reads OpenCV's YAML, JSON or XML; parts of it, such as R and T, may stand in a second file. `lens`: the model
/// of the user, where the file names none.
FileCalibration read_opencv_calibration(const CalibrationText& cameras, const CalibrationText& pose, int width,
                                        int height, std::optional<LensModel> lens);

/// Reads a pair of ROS camera_info, one file per camera.
FileCalibration read_ros_calibration(const CalibrationText& left, const CalibrationText& right, int width, int height,
                                     std::optional<LensModel> lens);

/// Reads the settings of ORB-SLAM 2 (LEFT.K ...) and 3 (Camera1.fx ..., Stereo.T_c1_c2).
FileCalibration read_orbslam_settings(const CalibrationText& file, int width, int height);

/// Reads the camchain of Kalibr: two cameras of the model pinhole with radtan or equidistant.
FileCalibration read_kalibr_camchain(const CalibrationText& file, int width, int height);

/// Reads a pair of EuRoC's sensor.yaml, one file per camera: T_BS takes points of each to the same body.
FileCalibration read_euroc_sensors(const CalibrationText& left, const CalibrationText& right, int width, int height);

/// Adds what a file says about the inertial sensor beside the cameras: EuRoC's sensor.yaml of an imu, or Kalibr's
/// imu.yaml, also with the entries below imu0.
void join_inertial_file(FileCalibration& cameras, const CalibrationText& file);

/// Reads calib.txt of Middlebury 2014, which ETH3D has, too.
StereoCalibration read_middlebury_calibration(const std::string& path, const std::string& text, int width, int height);

/// Reads KITTI's calib.txt (P0: .. P3:) or calib_cam_to_cam.txt (P_rect_00: ..; S_rect_00: .. must be the frames'
/// size). `first_camera` is 0 (grey pair) or 2 (colour pair).
StereoCalibration read_kitti_calibration(const std::string& path, const std::string& text, int first_camera, int width,
                                         int height);

/// Returns the number of the left camera in KITTI's file: the one that has a calibration there, or that of `pair`.
/// Throws where both pairs have one and `pair` is not known.
int kitti_camera(const std::string& path, const std::string& text, std::optional<KittiPair> pair);

/// Throws std::invalid_argument: "calibration FILE: " and what is wrong. A name that is too long for a line is cut.
[[noreturn]] void refuse_calibration(const std::string& path, const std::string& what);

/// Throws for a calibration of another eye size than the frames have; `found` is its size, or sizes, such as
/// "1280x720".
[[noreturn]] void refuse_other_size(const std::string& path, const std::string& found, int width, int height);

/// Throws for principal points so far from the middle that the file must be for images of another size. For files that
/// do not state one.
void check_size_by_centre(const StereoCalibration& calibration, const std::string& path);

/// Throws for numbers that no stereo camera has.
void check_plausible(const StereoCalibration& calibration, const std::string& path);

}  // namespace disparityd::calibration
