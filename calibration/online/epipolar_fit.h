// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// One point of the scene as a direction in the axes of each unrectified camera: x and y for z = 1, by the focal
/// lengths of the calibration.
struct RayPair {
    double left_x = 0;
    double left_y = 0;
    double right_x = 0;
    double right_y = 0;
    int block = 0;  ///< part of the image, 0 .. blocks - 1: errors within a block are not independent
};

/// The parameters of the right camera that the fit changes: three angles in radians, and the relative focal length.
enum Parameter { pitch, yaw, roll, focal, parameters };
using Parameters = std::array<double, parameters>;

/// Computes the vertical error of a pair, left y - right y in pixels of a rectified image of focal length `f`, if the
/// right camera has changed by `change`.
class VerticalError {
public:
    VerticalError(const StereoCalibration& calibration, double f, const Parameters& change);

    double operator()(const RayPair& pair) const;

    /// Returns the same, and the derivatives with respect to the change in `slopes`.
    double with_slopes(const RayPair& pair, Parameters& slopes) const;

private:
    std::array<double, 9> rotation_;
    std::array<double, 3> direction_;
    double f_;
    double focal_;
};

struct EpipolarFit {
    Parameters change{};
    Parameters deviation{};  ///< standard deviations, by the differences between blocks
    double inliers = 0;      ///< part of the pairs that the fit does not reject, 0 .. 1
    int blocks_used = 0;     ///< with at least one inlier
    bool solved = false;     ///< the normal equations could be solved
};

/// Fits all parameters at once, robustly (Tukey's weights). Yaw and focal length have little influence on rows, so a
/// prior holds them near 0, with standard deviations of 0.3 degrees and 0.5 %. Parameters whose entry in `fixed` is set
/// stay 0. The numbers are the same on every machine.
EpipolarFit fit_epipolar(const StereoCalibration& calibration, double f, std::span<const RayPair> pairs, int blocks,
                         const std::array<bool, parameters>& fixed = {});

/// Returns the median: the mean of the two middle values of an even number; 0 of no values.
double median(std::span<const double> values);

}  // namespace disparityd::calibration
