// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capture/calibration.h"

namespace disparityd::capture {

/// What self-calibration has changed in a calibration: the right camera, turned in its own axes, and its focal length.
/// Whole numbers, so that it means the same maps on every machine and after every way through a file. A pitch of one
/// degree is 17'453'293 nrad.
struct CalibrationCorrection {
    std::int32_t pitch_nrad = 0;  ///< about x: right pixels move up (for a positive angle), all by about as much
    std::int32_t yaw_nrad = 0;    ///< about y: right pixels move to the right, which shifts every disparity
    std::int32_t roll_nrad = 0;   ///< about z: the right picture turns clockwise
    std::int32_t focal_ppb = 0;   ///< the right focal lengths grow by this many billionths

    bool any() const { return *this != CalibrationCorrection{}; }
    bool operator==(const CalibrationCorrection&) const = default;
};

/// Whether two cameras can have moved so much: at most 3 degrees about each axis and 3 % of the focal length. Files may
/// say anything.
bool is_plausible(const CalibrationCorrection& correction);

/// The calibration with R' = exp(pitch, yaw, roll) R, T as it was, and right fx, fy times 1 + focal. `calibration` is
/// of raw cameras (not `rectified`).
StereoCalibration corrected(const StereoCalibration& calibration, const CalibrationCorrection& correction);

}  // namespace disparityd::capture
