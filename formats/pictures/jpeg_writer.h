// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::formats {

/// A JPEG has no side that is longer, px.
inline constexpr std::uint32_t most_jpeg_side = 65500;

/// An 8-bit picture, grey or BGR. It belongs to somebody else.
struct JpegPixels {
    const std::uint8_t* data = nullptr;
    int width = 0;      ///< px
    int height = 0;     ///< px
    int row_bytes = 0;  ///< from one row to the next
    bool grey = true;   ///< one byte per pixel, else three
};

/// How the cosine transform is computed: fast ones differ from the accurate one by a step or two of a value.
enum class JpegTransform { fast, accurate };

/// Compresses a picture; `quality` is 1 .. 100. Each thread has a compressor of its own. Throws std::runtime_error with
/// one line when the library refuses.
std::string jpeg_of(const JpegPixels& pixels, int quality, JpegTransform transform = JpegTransform::fast);

}  // namespace disparityd::formats
