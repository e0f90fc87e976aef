// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core.hpp>

namespace disparityd::images {

/// Writes the bytes as a new file, replacing one of that name. Throws std::runtime_error with one line (file, reason)
/// when the system refuses.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);

/// Writes an 8-bit or 16-bit picture as PNG. Errors as write_file.
void write_png(const std::string& path, const cv::Mat& picture);

/// Reads a picture as it is stored. Throws std::invalid_argument with one line when there is none.
cv::Mat read_image(const std::string& path);

}  // namespace disparityd::images
