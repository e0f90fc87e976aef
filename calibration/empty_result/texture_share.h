// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/image.h"

namespace disparityd::empty_result {

/// The share of an image, 0 .. 1, that has something to match: where brightness changes by more than noise, a ramp or
/// vignetting do. Measured on the image at a quarter of its size, where noise is small.
double texture_share(Plane<const std::uint8_t> image);

}  // namespace disparityd::empty_result
