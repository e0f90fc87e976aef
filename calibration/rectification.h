// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/calibration.h"
#include "kernels/matcher.h"

namespace disparityd::calibration {

/// The rectified image that the user wants. Another capture mode changes the pixels, not the field of view.
struct RectifiedGeometry {
    int width = 0;  ///< size of the whole rectified image; 0 = the capture size of one eye
    int height = 0;
    /// The part of the image that is matched and served; width 0 = the whole image.
    struct Region {
        int x = 0;
        int y = 0;
        int width = 0;
        int height = 0;
    } region;
};

/// Rectification maps, which it owns, and the geometry that follows from them. Built once per calibration and geometry.
class Rectification {
public:
    int width = 0;  ///< of the region, which all later steps have
    int height = 0;
    double f = 0;   ///< rectified focal length, px; 0 = unknown
    double cx = 0;  ///< principal point within the region, px
    double cy = 0;
    double baseline_mm = 0;            ///< 0 = unknown
    double disparity_offset = 0;       ///< px, added to a disparity before depth = f B / d
    std::uint64_t calibration_id = 0;  ///< hash of maps and geometry; the same bytes, the same id
    /// Row-major, from the captured camera's axes to the rectified one's (OpenCV's R1, R2); identity without maps.
    std::array<double, 9> left_rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::array<double, 9> right_rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
    bool unrectified = false;  ///< no calibration was known: pixels are as captured

    /// Returns views into this object, which are valid while it lives.
    Rectifier rectifier() const;
    DepthScale depth_scale() const;

    struct Maps {
        std::vector<std::int16_t> xy;
        std::vector<std::uint16_t> fraction;
    };
    Maps left, right;  ///< empty when the pixels are used as they are
    int crop_x = 0;
    int crop_y = 0;
};

/// Builds the maps of step 1 of docs/algorithm.md, in 1/32 px as OpenCV's CV_16SC2 has them. The rectified camera is
/// that of OpenCV's stereoRectify (CALIB_ZERO_DISPARITY, alpha 0); where an eye has a fisheye lens, f is that of the
/// lens. No calibration, or one that says "rectified" at the same size: no maps, only the region. Throws
/// std::invalid_argument when calibration, capture size and geometry do not fit together.
Rectification make_rectification(const std::optional<StereoCalibration>& calibration, int eye_width, int height,
                                 const RectifiedGeometry& geometry);

}  // namespace disparityd::calibration
