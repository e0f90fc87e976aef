// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "capture/svo/svo_format.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Both eyes side by side, as PixelFormat has them.
struct SvoPicture {
    PixelFormat format = PixelFormat::grey8;
    int width = 0;  ///< of both eyes, pixels
    int height = 0;
    cv::Mat pixels;  ///< rows without gaps
    bool damaged = false;
};

/// Unpacks a payload that is a picture by itself: PNG, strips of JPEG, or zstd whose content has the size of a raw
/// picture. A picture of one channel that is so wide that an eye would be more than twice as wide as high holds YUYV.
/// `stated` is the size that the file says. Throws std::runtime_error with what is wrong with it.
SvoPicture unpack_svo_picture(SvoPayload kind, std::span<const std::uint8_t> payload, std::optional<SvoSize> stated);

}  // namespace disparityd::capture
