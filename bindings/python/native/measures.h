// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// What follows from a disparity image, in floating-point numbers: NaN where the disparity is rejected. All arrays have
/// `count` pixels without gaps.
namespace disparityd::bindings {

/// Rectified geometry: Z = f B / (d + offset).
struct Geometry {
    double focal_baseline = 0;  ///< f B in px m
    double offset = 0;          ///< px
};

/// Disparities in px.
void to_px(const std::int16_t* disparity, std::size_t count, std::int16_t invalid, float* px);

/// Distances in m; infinity where d + offset is not more than 0.
void to_metres(const std::int16_t* disparity, std::size_t count, std::int16_t invalid, const Geometry& geometry,
               float* metres);

/// One sigma of the distance in m where one sigma of the disparity is `sigma_px`; NaN where the confidence is 0, as
/// nobody has measured these pixels; infinity where d + offset is not more than 0.
void to_metre_errors(const std::int16_t* disparity, const std::uint8_t* confidence, std::size_t count,
                     const Geometry& geometry, double sigma_px, float* errors);

}  // namespace disparityd::bindings
