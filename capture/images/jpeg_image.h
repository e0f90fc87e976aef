// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core.hpp>

namespace disparityd::capture {

/// Decodes a JPEG: grey as CV_8UC1, colour as CV_8UC3 (blue, green, red). A file that was cut off or is damaged gives
/// grey areas and shifted blocks without an error of the decoder, which only warns: it is refused here. Throws
/// std::invalid_argument with one line; `path` is for it.
cv::Mat decode_jpeg(std::span<const std::uint8_t> file, const std::string& path);

}  // namespace disparityd::capture
