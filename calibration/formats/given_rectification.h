// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// What OpenCV's stereoCalibrate and stereoRectify compute from both cameras and their pose, and programs write beside
/// them.
enum class RectificationResult {
    left_turn,
    right_turn,
    left_projection,
    right_projection,
    to_depth,
    essential,
    fundamental
};

/// Returns which result an OpenCV entry of this name is (R1, R2, P1, P2, Q, E, F and other spellings), if any.
std::optional<RectificationResult> rectification_result(std::string_view name);

/// Such an entry of a file.
struct GivenResult {
    RectificationResult what;
    std::string path;  ///< of the file, for messages
    std::string key;   ///< as the file spells it, printable
    int rows = 0;
    int columns = 0;
    std::vector<double> numbers;  ///< row by row
};

/// Compares what a file gives with its cameras and its pose, as far as that must agree whatever alpha, image size and
/// turn about the baseline it was made with. `unit_mm` is the unit of the file's lengths. Throws std::invalid_argument
/// with one line: file, key, found, expected, what to do. `raw` must have passed check_plausible().
void check_given_results(const std::vector<GivenResult>& given, const StereoCalibration& raw, double unit_mm);

}  // namespace disparityd::calibration
