// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "capture/images/image_header.h"

namespace disparityd::capture {

/// Returns the size of an image from its header, without decoding it; nullopt for files that are no image and for
/// damaged ones, which read_image() reports.
std::optional<ImageSize> peek_image_size(const std::string& path);

/// Decodes an image as it is stored: 1, 3 or 4 channels of 8 or 16 bits. The header is read first, so a small file that
/// claims a huge image costs neither time nor memory. Throws std::invalid_argument with one line when the file is
/// missing, cannot be read, is no PNG, JPEG, PBM, PGM, PPM, BMP, TIFF or WebP, is damaged, or larger than 8192
/// pixels on a side.
cv::Mat decode_image(const std::string& path);

/// Decodes an image that is in memory. Throws as the other one; `name` is for messages.
cv::Mat decode_image(std::span<const std::uint8_t> bytes, const std::string& name);

/// Says how images of 16 bits per channel become such of 8: of values with `bits` bits the upper 8 are kept
/// (value >> (bits - 8)), larger values become 255. 9 to 16; 0: as many as the file says, 16 where it says nothing.
struct DeepPixels {
    int bits = 0;
};

/// Returns how many bits the values of an image of 16 bits per channel have by its header, 9 to 16: PGM and PPM have
/// the largest value there.
int bits_of_values(const std::string& path);

/// Reads an image of 8 bits per channel, grey (CV_8UC1) or blue, green, red (CV_8UC3). Throws as decode_image(), and
/// when the pixels are neither of 8 nor of 16 bits.
cv::Mat read_image(const std::string& path, DeepPixels deep = {});

/// Converts a decoded image as read_image() does; `path` is for messages.
cv::Mat as_8_bits(const cv::Mat& image, const std::string& path, DeepPixels deep = {});

/// Returns the message for two images that must have one size.
std::string unequal_sizes(const std::string& first, ImageSize first_size, const std::string& second,
                          ImageSize second_size);

}  // namespace disparityd::capture
