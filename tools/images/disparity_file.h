// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "tools/images/disparity_map.h"

namespace disparityd::images {

/// Whether KITTI's 16-bit PNG can hold every disparity of the range: none is negative, none beyond 65535 / 256 px.
bool fits_png(DisparityRange range);

/// What KITTI's format holds: 16 bits of grey, disparity x 256; valid values are clamped to 1 .. 65535, 0 = rejected.
cv::Mat disparity_picture(const DisparityMap& map);

/// KITTI's format: disparity_picture() as a PNG.
/// Throws std::runtime_error when the file cannot be written.
void write_disparity_png(const std::string& path, const DisparityMap& map);

/// PFM: 32-bit floats, little endian (scale -1), bottom row first; rejected = +infinity, as Middlebury has it.
/// Throws std::runtime_error when the file cannot be written.
void write_disparity_pfm(const std::string& path, const FloatMap& values);
void write_disparity_pfm(const std::string& path, const DisparityMap& map);

/// 16-bit grey PNG of a depth plane in mm as the daemon serves it (0 = unknown, 65535 = farther than 65.534 m).
void write_depth_png(const std::string& path, Plane<const std::uint16_t> depth);

/// The reverse of the two writers. Throw std::invalid_argument (file, what was found, what is allowed).
FloatMap read_disparity_png(const std::string& path);
FloatMap read_disparity_pfm(const std::string& path);

}  // namespace disparityd::images
