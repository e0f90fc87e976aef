// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::capture {

/// The imagined ZED that looks at the rendered scene.
///
/// Its calibration for one eye of this size: a ZED mode, or any other size with the field of view of HD720.
calibration::StereoCalibration scene_calibration(int width, int height);

/// The same camera's factory file, all four modes.
std::string scene_calibration_conf();

/// The direction of a ray, z = 1, in the camera's axes.
struct RayDirection {
    float x;
    float y;
};

/// Returns the ray of each pixel of one eye, row by row: the camera model with its distortion, inverted. `each_row` may
/// be empty; it is called before every row, and what it throws ends the work and passes through.
std::vector<RayDirection> pixel_rays(const calibration::CameraModel& camera, int width, int height,
                                     const std::function<void()>& each_row = {});

}  // namespace disparityd::capture
