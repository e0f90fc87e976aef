// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bridges/web/images/image_view.h"
#include "bridges/web/images/live_frame.h"

/// Files of one frame. Each throws std::runtime_error with one line.
namespace disparityd::web {

/// Disparity as KITTI has it (16 bit, disparity x 256, 0 = rejected), depth and depth error in mm (16 bit), the others
/// as they are (8 bit).
std::string png_of(const LiveFrame& live, Image image);

/// The points that were measured, in metres in the optical frame (x right, y down, z ahead), with the left image's
/// colours: PLY, binary little endian.
std::string ply_of(const LiveFrame& live);

}  // namespace disparityd::web
