// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <opencv2/core.hpp>

#include "calibration/calibration.h"

namespace disparityd::test {

/// A rectified grey pair, and what it was rectified by.
struct RenderedPair {
    cv::Mat left;
    cv::Mat right;
    std::optional<calibration::StereoCalibration> calibration;
};

/// Renders the scene of this seed, its eyes of this size, and rectifies it by the scene's own calibration, whose
/// numbers `change` may change before.
RenderedPair rendered_pair(unsigned seed, cv::Size size,
                           const std::function<void(calibration::StereoCalibration&)>& change = {});

}  // namespace disparityd::test
