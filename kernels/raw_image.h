// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/image.h"

namespace disparityd {

/// How the bytes of a captured frame are laid out.
enum class PixelFormat : std::uint8_t {
    grey8,  ///< one byte of luma per pixel
    yuyv,   ///< YUV 4:2:2 packed, two bytes per pixel, luma in the even bytes; a UVC camera's native format
    bgr24,  ///< three bytes per pixel, blue first; image files in colour
};

constexpr int bytes_per_pixel(PixelFormat format) {
    switch (format) {
        case PixelFormat::grey8: return 1;
        case PixelFormat::yuyv: return 2;
        case PixelFormat::bgr24: return 3;
    }
    return 0;
}

enum class Eye : std::uint8_t { left, right };

/// One captured stereo frame: both eyes side by side in one picture of 2 * eye_width x height pixels, the left eye in
/// the left half. A view; the bytes belong to whoever lent them. eye_width is even for yuyv.
struct RawImage {
    const std::uint8_t* data = nullptr;
    PixelFormat format = PixelFormat::grey8;
    int eye_width = 0;
    int height = 0;
    std::ptrdiff_t stride = 0;  ///< bytes from one row to the next

    /// The rows of one eye, in bytes (width = eye_width * bytes_per_pixel).
    Plane<const std::uint8_t> eye(Eye which) const {
        const int eye_bytes = eye_width * bytes_per_pixel(format);
        return {data + (which == Eye::right ? eye_bytes : 0), eye_bytes, height, stride};
    }
};

}  // namespace disparityd
