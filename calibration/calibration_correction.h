// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// A correction by self-calibration: rotates the right camera about its own axes and changes its focal length. The
/// numbers are integers: they give the same maps on every machine, also after they were written and read. A pitch of
/// one degree is 17'453'293 nrad.
struct CalibrationCorrection {
    std::int32_t pitch_nrad = 0;  ///< about x: right pixels move up (for a positive angle), all by about as much
    std::int32_t yaw_nrad = 0;    ///< about y: right pixels move to the right, which shifts every disparity
    std::int32_t roll_nrad = 0;   ///< about z: the right picture turns clockwise
    std::int32_t focal_ppb = 0;   ///< the right focal lengths grow by this many billionths

    bool any() const { return *this != CalibrationCorrection{}; }
    bool operator==(const CalibrationCorrection&) const = default;
};

/// Returns whether a correction is at most 3 degrees about each axis and 3 % of the focal length, as that of a damaged
/// file may not be.
bool is_plausible(const CalibrationCorrection& correction);

/// Returns the calibration with R' = exp(pitch, yaw, roll) R, T as it was, and right fx, fy times 1 + focal.
/// `calibration` is of raw cameras (not `rectified`).
StereoCalibration corrected(const StereoCalibration& calibration, const CalibrationCorrection& correction);

}  // namespace disparityd::calibration
