// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace disparityd::test {

/// Both eyes side by side, rows without gaps.
struct Svo2Picture {
    int width = 0;  ///< both eyes
    int height = 0;
    std::vector<std::uint8_t> luma;
    std::vector<std::uint8_t> blue;  ///< chroma of 2 x 2 pixels, as in I420
    std::vector<std::uint8_t> red;
};

/// Draws frame `number`: a texture that moves down by 2 px a frame and stands `disparity` px further left in the right
/// eye, everywhere. `eye_width`, `height` and `disparity` are even. The same arguments give the same bytes.
Svo2Picture svo2_picture(int eye_width, int height, int disparity, int number);

/// The same picture in three colours, 3 bytes a pixel: red is the luma, green its inverse, blue the blue chroma. A
/// reader that mixes colours up shows it.
std::vector<std::uint8_t> svo2_rgb(const Svo2Picture& picture);

}  // namespace disparityd::test
