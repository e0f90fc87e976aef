// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

namespace disparityd::capture {

struct ImageSize {
    int width = 0;
    int height = 0;
    bool operator==(const ImageSize&) const = default;
};

/// The size of a PNG, PGM or PPM from its first bytes, without decoding it; none for other kinds of files and for
/// damaged ones, which read_image() tells.
std::optional<ImageSize> peek_image_size(const std::string& path);

/// An image of 8 bits per channel, grey (CV_8UC1) or blue, green, red (CV_8UC3). Throws std::invalid_argument with one
/// line when the file is missing, not an image, larger than 8192 pixels on a side, or has more bits.
cv::Mat read_image(const std::string& path);

/// The line for two images that must be of one size.
std::string unequal_sizes(const std::string& first, ImageSize first_size, const std::string& second,
                          ImageSize second_size);

}  // namespace disparityd::capture
