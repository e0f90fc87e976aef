// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include <opencv2/core.hpp>

#include "calibration/calibration.h"
#include "kernels/options.h"

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

/// Size and range of the pairs below.
inline const cv::Size made_size{336, 188};
inline constexpr DisparityRange made_range{0, 32};

// Rectified pairs of rendered scenes, each seed another one: scene, brightness, noise, and how wrong it is.

RenderedPair good_pair(unsigned seed);
RenderedPair exchanged_pair(unsigned seed);         ///< left is right
RenderedPair near_pair(unsigned seed);              ///< all disparities lie beyond the range
RenderedPair unaligned_pair(unsigned seed);         ///< the right image is moved in y, or turned
RenderedPair plain_pair(unsigned seed);             ///< black, grey, ramps, vignetting, out of focus, one lens covered
RenderedPair other_resolution_pair(unsigned seed);  ///< rectified by a calibration of another size of image

}  // namespace disparityd::test
