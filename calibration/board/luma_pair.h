// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/raw_image.h"

namespace disparityd::calibration {

/// Owns the luma of both eyes of a raw frame, not rectified.
class LumaPair {
public:
    explicit LumaPair(const RawImage& raw);

    Plane<const std::uint8_t> left() const { return {left_.data(), width_, height_, width_}; }
    Plane<const std::uint8_t> right() const { return {right_.data(), width_, height_, width_}; }

private:
    int width_;
    int height_;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
};

}  // namespace disparityd::calibration
