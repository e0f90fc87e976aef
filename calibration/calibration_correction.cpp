// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration_correction.h"

#include <algorithm>

#include <opencv2/core/matx.hpp>

#include "calibration/rotation.h"

namespace disparityd::calibration {

bool is_plausible(const CalibrationCorrection& correction) {
    constexpr std::int32_t most_turn = 52'359'878;
    constexpr std::int32_t most_focal = 30'000'000;
    const auto within = [](std::int32_t value, std::int32_t most) { return value >= -most && value <= most; };
    return within(correction.pitch_nrad, most_turn) && within(correction.yaw_nrad, most_turn) &&
           within(correction.roll_nrad, most_turn) && within(correction.focal_ppb, most_focal);
}

StereoCalibration corrected(const StereoCalibration& calibration, const CalibrationCorrection& correction) {
    if (!correction.any()) {
        return calibration;
    }
    constexpr double billionth = 1e-9;
    const cv::Matx33d turn = rotation_about(
        {correction.pitch_nrad * billionth, correction.yaw_nrad * billionth, correction.roll_nrad * billionth});
    const cv::Matx33d rotation = turn * cv::Matx33d(calibration.rotation.data());
    StereoCalibration result = calibration;
    std::copy(rotation.val, rotation.val + 9, result.rotation.begin());
    result.right.fx *= 1 + correction.focal_ppb * billionth;
    result.right.fy *= 1 + correction.focal_ppb * billionth;
    return result;
}

}  // namespace disparityd::calibration
