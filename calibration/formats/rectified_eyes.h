// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::calibration {

/// A 3x4 projection matrix of a file, row by row.
struct EyeProjection {
    std::string path;  ///< of the file, for messages
    std::string key;
    std::vector<double> matrix;  ///< 12 numbers
};

/// What two rectified eyes have in common, in the unit of the file.
struct RectifiedEyes {
    CameraModel left;
    CameraModel right;
    double shift = 0;  ///< x of the right eye's translation: the difference of both projections; -baseline
};

/// Reads the projections of two eyes whose images of width x height are rectified. Throws std::invalid_argument with
/// one line for what cannot be rectified images: focal lengths or centres in y that differ, skew, eyes that do not
/// stand side by side. `advice` ends the line for numbers that differ between the eyes.
RectifiedEyes rectified_eyes(const EyeProjection& left, const EyeProjection& right, int width, int height,
                             const std::string& advice =
                                 "give the calibration of the raw images, or that of images "
                                 "rectified together");

}  // namespace disparityd::calibration
