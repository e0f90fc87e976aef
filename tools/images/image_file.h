// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

namespace disparityd::images {

/// Writes the bytes as a new file in place of one of that name, as a whole or not at all: who reads at the same time
/// sees the old or the new one, and two writers leave the file of one of them. Pipes and devices are written to. Throws
/// base::DiskFull or std::runtime_error with one line (file, reason) when the system refuses.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);

/// The same for text, or bytes that were appended to a string.
void write_file(const std::string& path, std::string_view text);

/// Writes an 8-bit or 16-bit picture as PNG. Errors as write_file.
void write_png(const std::string& path, const cv::Mat& picture);

/// Throws std::invalid_argument with one line unless the name ends in one of these, such as ".png"; the case of the
/// letters does not matter.
void check_ending(const std::string& path, std::initializer_list<const char*> allowed);

/// Whether the name ends so; the case of the letters does not matter.
bool has_ending(const std::string& path, const char* ending);

/// Throws std::invalid_argument unless write_picture() knows the format that the name says.
void check_picture_name(const std::string& path);

/// Writes an 8-bit picture in the format that its name says: .png, .jpg or .jpeg (with a little loss). Throws
/// std::invalid_argument for another ending; other errors as write_file.
void write_picture(const std::string& path, const cv::Mat& picture);

/// Returns an 8-bit picture, grey or blue, green, red, as a JPEG of this quality, 1 to 100. The same picture gives the
/// same bytes with the same libjpeg-turbo.
std::string jpeg_of(const cv::Mat& picture, int quality);

/// Reads a picture as it is stored. Throws as capture::decode_image() does.
cv::Mat read_image(const std::string& path);

}  // namespace disparityd::images
