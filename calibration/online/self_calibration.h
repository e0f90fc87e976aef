// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "calibration/calibration_correction.h"
#include "calibration/online/epipolar_fit.h"
#include "calibration/rectification.h"
#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::calibration {

/// Returns how many rows above and below its own a corner is searched in the other eye; f of rectified images, in px.
int rows_searched(double f);

/// The result of SelfCalibration::solve().
struct SelfCalibrationResult {
    bool accepted = false;  ///< `correction` is well determined, and better on frames that it was not fitted to
    std::string reason;     ///< one line for people: why it was accepted or not
    CalibrationCorrection correction;  ///< with respect to the factory calibration
    Parameters change{};               ///< as fitted, also when it was not accepted: radians, relative focal length
    Parameters deviation{};            ///< its standard deviations
    double error_before = 0;           ///< median of |left y - right y| with the factory calibration, rectified px
    double error_after = 0;            ///< the same with the correction, on pairs that its fit did not see
    double offset_before = 0;          ///< median of left y - right y, with its sign
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
    explicit SelfCalibration(StereoCalibration factory);

    /// Adds the matches of one more frame: a pair that was rectified by `used`, which has the correction `already`.
    /// Searches disparities within `range`. Keeps nothing of the images. `give_up` as for match_corners().
    void add(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const Rectification& used,
             const CalibrationCorrection& already, DisparityRange range, const std::atomic<bool>* give_up = nullptr);

    int frames() const { return static_cast<int>(frames_.size()); }
    int matches() const;

    /// Estimates a correction from all frames. It is accepted only when it is also better than the one `in_use`.
    SelfCalibrationResult solve(const CalibrationCorrection& in_use = {}) const;

    void clear() { frames_.clear(); }

private:
    StereoCalibration factory_;
    double f_ = 0;           ///< of the rectified images, px
    double half_width_ = 0;  ///< of the rectified image, px
    std::vector<std::vector<RayPair>> frames_;
};

}  // namespace disparityd::calibration
