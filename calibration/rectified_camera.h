// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// The camera that both eyes are rectified to, and what turns the raw ones to it.
struct RectifiedCamera {
    std::array<double, 9> turn[2]{};  ///< row-major, of the left and the right eye: OpenCV's R1 and R2
    double f = 0;                     ///< px, both ways
    double cx = 0;                    ///< px, of both eyes
    double cy = 0;
    double baseline_mm = 0;  ///< 0 where the eyes do not lie side by side
};

/// Returns the camera of stereoRectify of OpenCV 4.6 (CALIB_ZERO_DISPARITY, alpha 0: valid pixels only) for a rectified
/// image of this size. It is computed here, of sums, products, quotients and roots alone: every machine gets the same
/// bits, whatever OpenCV is installed. A fisheye's whole field fits into no flat image: where an eye has such a lens,
/// the image is as large in the middle as in the eyes, and the optical axes lie, in the mean of both, where they lie in
/// the raw images. Numbers may not be finite where those of the calibration are those of no camera.
RectifiedCamera rectified_camera(const StereoCalibration& calibration, int width, int height);

}  // namespace disparityd::calibration
