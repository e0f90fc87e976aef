// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace disparityd::images {

/// 256 colours (BGR) from far, dark violet, over blue and green to near, light yellow. Lightness rises evenly as the
/// eye sees it, so that the order also shows in grey and to the colour-blind; no entry is black, which marks rejected
/// pixels.
const std::array<cv::Vec3b, 256>& colour_map();

}  // namespace disparityd::images
