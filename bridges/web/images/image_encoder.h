// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bridges/web/images/image_view.h"
#include "bridges/web/images/live_frame.h"

namespace disparityd::web {

/// Encodes a view of a frame, or returns what was encoded before. Returns nullptr when the frame does not carry the
/// product. Call it from one thread only. Throws std::runtime_error when a library refuses.
std::shared_ptr<const EncodedImage> encode(const LiveFrame& live, const ImageView& view);

/// A part of the depth image for a cloud of points: pixel (i, j) is that at (i * step, j * step) of the whole image.
struct DepthGrid {
    int step = 1;
    int width = 0;
    int height = 0;
    std::shared_ptr<const std::string> bytes;  ///< u16, mm; 0 = unknown, 65535 = too far; zlib's format
};

/// Returns nullptr when the frame has no disparity or no calibration.
std::shared_ptr<const DepthGrid> depth_grid(const disparity::Frame& frame, int step);

}  // namespace disparityd::web
