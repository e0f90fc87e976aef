// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "capture/calibration.h"

namespace disparityd::calibration {

/// The same place of the room, as directions in the axes of each camera as captured: x and y for z = 1, under the
/// focal lengths of the calibration.
struct RayPair {
    double left_x = 0;
    double left_y = 0;
    double right_x = 0;
    double right_y = 0;
    int block = 0;  ///< which part of the image it is in, 0 .. blocks - 1: errors within a block are not independent
};

/// What may have changed of the right camera since it was calibrated: radians, and the part of the focal length.
enum Parameter { pitch, yaw, roll, focal, parameters };
using Parameters = std::array<double, parameters>;

/// How far the rows of the two rectified images are apart, in pixels of a rectified image of focal length `f`:
/// left y - right y of each pair, if the right camera has changed by `change`.
class VerticalError {
public:
    VerticalError(const capture::StereoCalibration& calibration, double f, const Parameters& change);

    double operator()(const RayPair& pair) const;

    /// The same with its derivatives with respect to the change.
    double with_slopes(const RayPair& pair, Parameters& slopes) const;

private:
    std::array<double, 9> rotation_;
    std::array<double, 3> direction_;
    double f_;
    double focal_;
};

struct EpipolarFit {
    Parameters change{};
    Parameters deviation{};  ///< standard deviations, from how much the blocks disagree
    double inliers = 0;      ///< part of the pairs that the fit does not reject, 0 .. 1
    int blocks_used = 0;     ///< with at least one inlier
    bool solved = false;     ///< the normal equations could be solved
};

/// Fits all parameters at once, robustly (Tukey's weights). Yaw and focal length have so little influence on rows that
/// they are held near 0 with a standard deviation of 0.3 degrees and 0.5 %; what is left of them does not turn into
/// pitch or roll. Those whose entry in `fixed` is set stay 0. The same numbers on every machine.
EpipolarFit fit_epipolar(const capture::StereoCalibration& calibration, double f, std::span<const RayPair> pairs,
                         int blocks, const std::array<bool, parameters>& fixed = {});

/// The middle value; the mean of the two middle ones of an even number; 0 of none.
double median(std::span<const double> values);

}  // namespace disparityd::calibration
