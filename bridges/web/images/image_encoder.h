// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bridges/web/images/image_view.h"
#include "bridges/web/images/live_frame.h"

namespace disparityd::web {

/// So many ranges of colours are drawn of a frame, besides the one that the searched disparities can show.
inline constexpr std::size_t most_ranges = 4;

/// Encodes a view of a frame, or returns what was encoded before. What is wanted with a fifth range of colours gets the
/// one that the searched disparities can show; the image says which it has. Returns nullptr when the frame does not
/// carry the product. Call it from one thread only. Throws std::runtime_error when a library refuses.
std::shared_ptr<const EncodedImage> encode(const LiveFrame& live, const ImageView& view);

/// Returns the grid of a frame, or what was made before; nullptr when the frame has no disparity or no calibration.
/// Call it from one thread only. `step`: 0 = none; the next one of 1, 2, 4, 8, 16, 32 and 64 is taken.
std::shared_ptr<const DepthGrid> depth_grid(const LiveFrame& live, int step);

}  // namespace disparityd::web
