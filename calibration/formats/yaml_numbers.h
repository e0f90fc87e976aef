// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/matx.hpp>
#include <yaml-cpp/yaml.h>

#include "calibration/inertial_calibration.h"

/// Numbers of calibrations in YAML. All throw std::invalid_argument with one line that names file and key.
namespace disparityd::calibration {

/// Reads a number.
double yaml_number(const std::string& path, const std::string& key, const YAML::Node& node);

/// Reads a list of `count` numbers; 0: of any length.
std::vector<double> yaml_numbers(const std::string& path, const std::string& key, const YAML::Node& list,
                                 std::size_t count);

/// Reads a pose in metres: four lists of four, or 16 numbers, also as OpenCV writes them. Refuses what is no rotation
/// and translation.
cv::Matx44d yaml_pose(const std::string& path, const std::string& key, const YAML::Node& node);

/// Returns a pose in metres as one in mm.
Pose pose_of_metres(const cv::Matx44d& metres);

}  // namespace disparityd::calibration
