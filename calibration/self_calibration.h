// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/epipolar_fit.h"
#include "capture/calibration.h"
#include "capture/calibration_correction.h"
#include "capture/rectification.h"
#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::calibration {

/// How many rows above and below its own a corner is looked for in the other eye; f in px, of rectified images.
int rows_searched(double f);

/// What a set of frames says about a calibration.
struct SelfCalibrationResult {
    bool accepted = false;  ///< `correction` is well determined, and better on frames that it was not fitted to
    std::string reason;     ///< one line for people: why it was accepted or not
    capture::CalibrationCorrection correction;  ///< in all, with respect to the factory calibration
    Parameters change{};       ///< as fitted, radians and part of the focal length, also what was not taken over
    Parameters deviation{};    ///< its standard deviations
    double error_before = 0;   ///< median of |left y - right y| with the factory calibration, rectified px
    double error_after = 0;    ///< the same with the correction, on pairs that its fit did not see
    double offset_before = 0;  ///< median of left y - right y, with its sign
    double offset_after = 0;
    int frames = 0;
    int matches = 0;
};

/// Estimates how the two cameras have moved against each other since they were calibrated: pitch and roll, and yaw and
/// focal ratio only where their standard deviations are worth less than 0.05 px of disparity. Collects corner matches
/// of rectified frames; knows neither pipeline nor files. One thread at a time. The same frames give the same result,
/// bit for bit, on every machine.
class SelfCalibration {
public:
    /// `factory` is of raw cameras: throws std::invalid_argument for one that is `rectified`.
    explicit SelfCalibration(capture::StereoCalibration factory);

    /// Takes the matches of one more frame: a pair that `used` has rectified, with the calibration that `already`
    /// corrects. `range`: the disparities that are looked at. Keeps nothing of the images. `give_up` as for
    /// match_corners().
    void add(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const capture::Rectification& used,
             const capture::CalibrationCorrection& already, DisparityRange range,
             const std::atomic<bool>* give_up = nullptr);

    int frames() const { return static_cast<int>(frames_.size()); }
    int matches() const;

    /// What all frames say together. A correction is accepted only when it is better than what is `in_use` as well.
    SelfCalibrationResult solve(const capture::CalibrationCorrection& in_use = {}) const;

    void clear() { frames_.clear(); }

private:
    capture::StereoCalibration factory_;
    double f_ = 0;           ///< of the rectified images, px
    double half_width_ = 0;  ///< of the rectified image, px
    std::vector<std::vector<RayPair>> frames_;
};

}  // namespace disparityd::calibration
