// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calibration/calibration.h"

/// The file formats behind read_calibration(), one file of code each. All throw std::invalid_argument with one line:
/// file, place, what was found, what is allowed. `text` is the content of the file `path`.
namespace disparityd::calibration {

/// Reads a factory file SN<serial>.conf.
StereoCalibration read_factory_conf(const std::string& path, const std::string& text, int width, int height);

/// Reads OpenCV's YAML or XML; `extrinsics` may name a second file with R and T, or be empty.
StereoCalibration read_opencv_calibration(const std::string& path, const std::string& extrinsics, int width,
                                          int height);

/// Reads a pair of ROS camera_info, one file per camera.
StereoCalibration read_ros_calibration(const std::string& left, const std::string& right, int width, int height);

/// Reads calib.txt of Middlebury 2014.
StereoCalibration read_middlebury_calibration(const std::string& path, const std::string& text, int width, int height);

/// Reads KITTI's calib.txt (P0: .. P3:) or calib_cam_to_cam.txt (P_rect_00: ..; S_rect_00: .. must be the frames'
/// size). `first_camera` is 0 (grey pair) or 2 (colour pair).
StereoCalibration read_kitti_calibration(const std::string& path, const std::string& text, int first_camera, int width,
                                         int height);

/// Throws for a calibration of another eye size than the frames have; `found` is its size, or sizes, such as
/// "1280x720".
[[noreturn]] void refuse_other_size(const std::string& path, const std::string& found, int width, int height);

/// Throws for numbers that no stereo camera has.
void check_plausible(const StereoCalibration& calibration, const std::string& path);

}  // namespace disparityd::calibration
