// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core.hpp>

/// One decoder for each kind of image file. Each takes a whole file whose header read_image_header() has accepted, and
/// returns its pixels as they are stored: grey (one channel), or blue, green, red (three) and alpha (four), of 8 or 16
/// bits. Each writes nothing to stderr and throws std::invalid_argument with one line, which begins with
/// `path`, where the file is damaged or of a kind that is not read. They are the ones of libjpeg-turbo, libpng, libtiff
/// and libwebp: OpenCV's own module for this brings more than a hundred libraries into every process. Any thread may
/// call them.
namespace disparityd::capture {

/// A larger image is refused, px.
inline constexpr int largest_image_side = 8192;

/// Grey and colour, not the four inks of print.
cv::Mat decode_jpeg(std::span<const std::uint8_t> file, const std::string& path);

/// Palettes become colours, less than 8 bits become 8; grey with alpha becomes colour with alpha.
cv::Mat decode_png(std::span<const std::uint8_t> file, const std::string& path);

/// Rows or tiles, and whatever compression libtiff was built with: up to 8 bits all that it makes colours of, 16 bits
/// where they are grey or red, green, blue. The first picture of several.
cv::Mat decode_tiff(std::span<const std::uint8_t> file, const std::string& path);

/// Still pictures.
cv::Mat decode_webp(std::span<const std::uint8_t> file, const std::string& path);

/// PBM, PGM and PPM. Bytes are returned as they are; 8-bit values as text are scaled so that the largest one that the
/// file states becomes 255, as OpenCV has it. PFM, which holds floats, is refused.
cv::Mat decode_pnm(std::span<const std::uint8_t> file, const std::string& path);

/// 8 bits with a palette, 24 and 32 bits, without compression.
cv::Mat decode_bmp(std::span<const std::uint8_t> file, const std::string& path);

/// Throws std::invalid_argument: the file was cut off, and `least` bytes should be there.
[[noreturn]] void refuse_cut_image(const std::string& path, std::uint64_t found, std::uint64_t least);

/// Throws std::invalid_argument: the image is to be turned or mirrored before it is shown, as EXIF and TIFF number it.
[[noreturn]] void refuse_turned_image(const std::string& path, int orientation);

}  // namespace disparityd::capture
