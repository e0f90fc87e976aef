// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "kernels/raw_image.h"

namespace disparityd::capture {

/// How the pixels of a camera become those that are lent.
enum class Packing : std::uint8_t {
    plain,  ///< as they are
    jpeg,   ///< each frame is a JPEG
    y8i,    ///< a byte of each eye in turn, the left one first
    y12i,   ///< 12 bits of each eye in turn, two in three bytes, the lowest bits first; the upper 8 are lent
    bayer,  ///< a byte of one colour each; the other two are interpolated within the eye
};

/// A format that is read from cameras.
struct CameraFormat {
    std::string_view name;  ///< of the URI's format=
    std::uint32_t fourcc;   ///< the driver's
    int bytes;              ///< of a pixel as it is sent; 0: JPEGs
    Packing packing;
    PixelFormat lent;
    int blue_row = 0;     ///< of Bayer: where the blue one of four is, from the top
    int blue_column = 0;  ///< from the left

    /// Whether each pixel has a value of both eyes.
    bool interleaved() const { return packing == Packing::y8i || packing == Packing::y12i; }
};

/// Returns nullptr when none has this name.
const CameraFormat* camera_format_of_name(std::string_view name);

/// Returns nullptr when none is what drivers call so.
const CameraFormat* camera_format_of_fourcc(std::uint32_t fourcc);

/// "yuyv, grey, mjpeg ... or rggb8"
std::string camera_format_names();

/// Returns the number of 1 to 4 characters, spaces behind them where there are fewer.
constexpr std::uint32_t fourcc_of(std::string_view text) {
    std::uint32_t code = 0;
    for (unsigned i = 0; i < 4; ++i) {
        const char letter = i < text.size() ? text[i] : ' ';
        code |= static_cast<std::uint32_t>(static_cast<unsigned char>(letter)) << (8 * i);
    }
    return code;
}

}  // namespace disparityd::capture
