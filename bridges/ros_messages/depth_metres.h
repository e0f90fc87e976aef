// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros {

/// Depths of a frame's pixels in metres, row by row, as REP-118 has them: NaN unknown, +infinity too far to measure.
struct Depths {
    std::uint32_t width = 0;    ///< px
    std::uint32_t height = 0;   ///< px
    std::vector<float> metres;  ///< width * height
};

/// Returns the depths from the first of these products (depth, disparity) that the frame carries. Nothing when it
/// carries none, or only the disparity without a focal length or baseline.
std::optional<Depths> depths_of(const disparity::Frame& frame, std::span<const disparity::Product> order);

/// Returns a length in millimetres of 16 bits as metres: 0 is unknown, 65535 is out of range.
std::vector<float> metres_of(std::span<const std::uint8_t> millimetres);

}  // namespace disparityd::ros
