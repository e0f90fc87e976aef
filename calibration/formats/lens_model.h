// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/calibration.h"

/// What calibration files say about a lens. Only the Brown model is rectified: every other one is refused by its name,
/// as its coefficients would give wrong distances if they were read as Brown's. All throw std::invalid_argument with
/// one line; `path` and `key` say where the numbers stand.
namespace disparityd::calibration {

/// Returns k1 k2 p1 p2 k3 from coefficients in OpenCV's order. Fewer than five are filled up with zeros. Beyond the
/// fifth only zeros are taken: the rational model has 8 of them, thin prisms make them 12, a tilted sensor 14.
std::array<double, 5> brown_coefficients(const std::string& path, const std::string& key,
                                         const std::vector<double>& coefficients);

/// Takes the names of the Brown model and of a pinhole, with any case, blanks, hyphens and underscores; refuses others.
/// "rational_polynomial" is taken, too: brown_coefficients() looks at its numbers.
void check_lens_model(const std::string& path, const std::string& key, std::string_view name);

/// Refuses the coefficients of a fisheye lens; `found` says what gave it away, such as "'equidistant'".
[[noreturn]] void refuse_fisheye(const std::string& path, const std::string& key, const std::string& found);

/// Returns the camera of a 3x3 matrix, row by row, without distortion. Refuses skew, which is not applied, and anything
/// but zeros and a one in the other places.
CameraModel camera_of_matrix(const std::string& path, const std::string& key, const std::vector<double>& matrix);

/// Returns a name in lower case without blanks, hyphens, underscores and points: spellings of one name become equal.
std::string plain_name(std::string_view name);

}  // namespace disparityd::calibration
