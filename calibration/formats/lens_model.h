// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibration/calibration.h"

/// What calibration files say about a lens. Pinholes and equidistant fisheyes are rectified; every other model is
/// refused by its name, as its coefficients would give wrong distances. All throw std::invalid_argument with one line;
/// `path` and `key` say where the numbers stand.
namespace disparityd::calibration {

/// Sets a camera's lens from coefficients in OpenCV's order: k1 to k4 of a fisheye; k1 k2 p1 p2 of a pinhole and what
/// stands behind them, 4, 5, 8, 12 or 14 in all. Only zeros may be of any other count.
void set_lens(CameraModel& camera, const std::string& path, const std::string& key,
              const std::vector<double>& coefficients, LensModel lens);

/// Returns the lens model of a name, with any case, blanks, hyphens and underscores; refuses names that are not known.
LensModel named_lens(const std::string& path, const std::string& key, std::string_view name);

/// Refuses what only hints at a fisheye lens; `found` says what gave it away, such as "k1 to k4 without p1 and p2".
[[noreturn]] void refuse_fisheye(const std::string& path, const std::string& key, const std::string& found);

/// Returns the camera of a 3x3 matrix, row by row, without distortion. Refuses skew, which is not applied, and anything
/// but zeros and a one in the other places.
CameraModel camera_of_matrix(const std::string& path, const std::string& key, const std::vector<double>& matrix);

/// Returns a name in lower case without blanks, hyphens, underscores and points: spellings of one name become equal.
std::string plain_name(std::string_view name);

}  // namespace disparityd::calibration
