// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <opencv2/core.hpp>

#include "kernels/image.h"

namespace disparityd::calibration {

/// Returns a grey image as OpenCV takes it: a view of the same pixels, which are only to be read.
inline cv::Mat grey_view(Plane<const std::uint8_t> image) {
    return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
            static_cast<std::size_t>(image.stride)};
}

}  // namespace disparityd::calibration
