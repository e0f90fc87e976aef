// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace disparityd::capture {

/// Returns the JPEGs of a payload that begins with their sizes, 64 bits each, and goes on with as many JPEGs of these
/// sizes without a gap. Nothing for any other payload.
std::vector<std::span<const std::uint8_t>> jpeg_strips_of(std::span<const std::uint8_t> payload);

/// Decodes grey JPEGs of one width and puts each below the one before. Throws std::runtime_error with what is wrong.
cv::Mat decode_jpeg_strips(const std::vector<std::span<const std::uint8_t>>& strips);

}  // namespace disparityd::capture
