// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capture/calibration.h"
#include "capture/rectification.h"
#include "tests/fuzz/outcome.h"

namespace disparityd::fuzz {

/// What a recording keeps of a calibration that was accepted must be accepted again, and be the same.
inline void expect_same_after_text(const capture::StereoCalibration& calibration) {
    const std::string text = capture::to_text(calibration);
    expect(capture::to_text(capture::calibration_from_text(text, "text")) == text, "a calibration changed in its text");
}

/// Numbers that passed for plausible make maps, or are refused.
inline void rectify(capture::StereoCalibration calibration, std::string_view origin) {
    calibration.origin = origin;
    accepted("calibration " + calibration.origin, [&] {
        const auto maps = capture::make_rectification(calibration, calibration.width, calibration.height, {});
        maps.rectifier();
        maps.depth_scale();
    });
}

}  // namespace disparityd::fuzz
