// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/calibration.h"

namespace disparityd::capture {

/// Where calibrations of cameras lie unless the user says otherwise; folders between colons.
inline constexpr const char* standard_calibration_folders = "/etc/disparityd/calibration:/usr/local/zed/settings";

/// The names between the colons, without empty ones.
std::vector<std::string> folder_list(const std::string& text);

/// The calibration of the camera with this serial number: the first of SN<serial>.conf, <serial>.yaml, <serial>.yml and
/// <serial>.xml in the first folder that has one. nullopt: there is none. Throws std::invalid_argument with one line
/// when the file is damaged or cannot be that of a stereo camera.
std::optional<StereoCalibration> find_camera_calibration(const std::string& serial,
                                                         const std::vector<std::string>& folders, int eye_width,
                                                         int height);

/// A camera's two eyes are alike, look the same way and stand side by side: throws std::invalid_argument when the
/// numbers say otherwise, as those of another camera or a half-written file may.
void check_camera_plausible(const StereoCalibration& calibration);

}  // namespace disparityd::capture
