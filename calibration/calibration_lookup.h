// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// The default folders of camera calibrations, separated by colons.
inline constexpr const char* standard_calibration_folders = "/etc/disparityd/calibration:/usr/local/zed/settings";

/// Returns the names between the colons, without empty ones.
std::vector<std::string> folder_list(const std::string& text);

/// Reads the calibration of the camera with this serial number: the first of SN<serial>.conf, <serial>.yaml,
/// <serial>.yml, <serial>.xml and zed_calibration_<serial>.yml in the first folder that has one. Returns nothing when
/// there is none. Throws std::invalid_argument with one line when the file is damaged or cannot belong to a stereo
/// camera.
std::optional<StereoCalibration> find_camera_calibration(const std::string& serial,
                                                         const std::vector<std::string>& folders, int eye_width,
                                                         int height);

/// Checks that the two eyes are alike, look the same way and stand side by side. Throws std::invalid_argument when they
/// do not: the file may belong to another camera, or may be half-written.
void check_camera_plausible(const StereoCalibration& calibration);

}  // namespace disparityd::calibration
