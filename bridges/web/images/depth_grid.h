// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

namespace disparityd::web {

/// A part of the depth image for a cloud of points: pixel (i, j) is that at (i * step, j * step) of the whole image.
struct DepthGrid {
    int step = 1;
    int width = 0;
    int height = 0;
    std::shared_ptr<const std::string> bytes;  ///< u16, mm; 0 = unknown, 65535 = too far; zlib's format
};

}  // namespace disparityd::web
