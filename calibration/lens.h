// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "calibration/calibration.h"

namespace disparityd::calibration {

struct ImagePoint {
    double x = 0;
    double y = 0;
};

/// Takes rays of one camera to its image, in double precision and with arithmetic of its own: no function of the C
/// library that rounds otherwise elsewhere, no product and sum in one rounding. Every machine gets the same bits.
class Lens {
public:
    explicit Lens(const CameraModel& camera);

    /// Returns where the ray (x, y, z) lies in the raw image, px; not a number where z is not more than 0.
    ImagePoint pixel_of(double x, double y, double z) const;

    /// Returns x and y of the ray (x, y, 1) that a pinhole lens takes to this pixel, nearly: the distortion at the ray
    /// is taken away from the pixel five times over, as in OpenCV's undistortPoints.
    ImagePoint ray_of(ImagePoint pixel) const;

private:
    /// Returns what distance from the axis makes longer a ray (x, y, 1).
    double radial(double x, double y) const;
    /// Returns `place` and what the lens shifts such a ray by besides.
    ImagePoint shifted(ImagePoint place, double x, double y) const;
    ImagePoint pinhole(double x, double y) const;
    ImagePoint fisheye(double x, double y) const;

    CameraModel camera_;
    bool tilted_ = false;
    std::array<double, 9> tilt_{};    ///< row-major, of the sensor's plane; used where tilted_
    std::array<double, 9> untilt_{};  ///< back from it
};

/// Returns the coefficients as files hold them: 5 of Brown's model, 8, 12 or 14 where more are in use, 4 of a fisheye.
std::vector<double> lens_coefficients(const CameraModel& camera);

/// Sets lens model and coefficients from as many numbers as lens_coefficients() gives; returns whether the count fits.
bool set_lens_coefficients(CameraModel& camera, const std::vector<double>& coefficients);

}  // namespace disparityd::calibration
