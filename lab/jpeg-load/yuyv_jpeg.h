// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace disparityd::lab {

/// Returns a frame of YUYV as a JPEG with the same columns of chroma, as most cameras send it. Sizes are in pixels of
/// the whole frame, `quality` is libjpeg's, 1 to 100. Throws std::runtime_error with TurboJPEG's reason.
std::vector<std::uint8_t> jpeg_of(const std::vector<std::uint8_t>& yuyv, int width, int height, int quality);

}  // namespace disparityd::lab
