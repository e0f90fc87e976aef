// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "tools/images/disparity_map.h"

namespace disparityd::images {

/// What turns a pixel into a point: x = (u - cx) Z / f, y = (v - cy) Z / f. px.
struct PointCamera {
    Metric metric;
    double cx = 0;
    double cy = 0;
};

/// Returns a file of points in metres, binary, little endian: of each pixel with a distance, row by row, x (right),
/// y (down), z (ahead) and the colour of `left` (grey or BGR, of the map's size). `format` is "ply" (float x, y, z;
/// uchar red, green, blue) or "pcd" (version 0.7, fields x y z rgb). The same bytes on all machines.
std::string point_file(const std::string& format, const DisparityMap& map, const PointCamera& camera,
                       const cv::Mat& left);

}  // namespace disparityd::images
