// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/matx.hpp>

/// How far two statements of a file about the same pose of the cameras may differ. docs/calibration.md has the reasons.
namespace disparityd::calibration {

/// Rotations that were rounded to three decimals differ by at most 0.103 degrees, those with four by 0.01.
inline constexpr double largest_turn_degrees = 0.12;
/// T in whole millimetres, the usual rounding, turns that of a baseline of 60 mm by this.
inline constexpr double largest_direction_degrees = 0.5;
/// Of the baseline: T in whole millimetres changes that of 60 mm by this.
inline constexpr double largest_baseline_share = 0.01;

/// Returns the angle of the rotation that leads from one rotation to the other, 0 to 180.
double degrees_between(const cv::Matx33d& a, const cv::Matx33d& b);

/// Returns the angle between two directions of any length, 0 to 180; NaN where one is zero.
double degrees_between(const cv::Vec3d& a, const cv::Vec3d& b);

/// Returns whether the rows have length 1 and are at right angles, in a right-handed order.
bool is_rotation(const cv::Matx33d& matrix);

/// Returns an angle with three digits, such as "0.417 degrees".
std::string degrees_text(double degrees);

}  // namespace disparityd::calibration
