// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace disparityd::formats {

/// A picture of one grey channel, of blue, green, red, or of these and alpha. It belongs to somebody else.
struct PngPixels {
    const std::uint8_t* data = nullptr;  ///< values of 16 bits are little endian
    int width = 0;                       ///< px, 1 or more
    int height = 0;                      ///< px, 1 or more
    std::size_t row_bytes = 0;           ///< from one row to the next
    int channels = 1;                    ///< 1, 3 or 4
    int bits = 8;                        ///< of each channel, 8 or 16
};

/// What the compressor is to expect. Both are made for speed, not for size.
enum class PngContent {
    picture,     ///< neighbours are alike: differences are stored, and runs of them
    few_values,  ///< the same values come again, as in an image of depth: they are searched for
};

/// Returns a PNG. The same pixels give the same bytes with the same libpng and zlib. Throws std::bad_alloc, or
/// std::runtime_error with one line where libpng refuses the picture. Any thread.
std::string png_of(const PngPixels& pixels, PngContent content);

}  // namespace disparityd::formats
