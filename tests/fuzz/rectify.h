// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/calibration.h"
#include "calibration/rectification.h"
#include "tests/fuzz/outcome.h"

namespace disparityd::fuzz {

/// What a recording keeps of a calibration that was accepted must be accepted again, and be the same.
inline void expect_same_after_text(const calibration::StereoCalibration& calibration) {
    const std::string text = calibration::to_text(calibration);
    expect(calibration::to_text(calibration::calibration_from_text(text, "text")) == text,
           "a calibration changed in its text");
}

/// Numbers that passed for plausible make maps, or are refused.
inline void rectify(calibration::StereoCalibration calibration, std::string_view origin) {
    calibration.origin = origin;
    accepted("calibration " + calibration.origin, [&] {
        const auto maps = calibration::make_rectification(calibration, calibration.width, calibration.height, {});
        maps.rectifier();
        maps.depth_scale();
    });
}

}  // namespace disparityd::fuzz
