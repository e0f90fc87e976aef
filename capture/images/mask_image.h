// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/image.h"

namespace disparityd::capture {

/// A picture of what is masked. It has no pixels where none was read.
struct MaskImage {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> grey;

    Plane<const std::uint8_t> plane() const { return {grey.empty() ? nullptr : grey.data(), width, height, width}; }
};

/// Reads a grey image of 8 bits. Throws std::invalid_argument with one line as decode_image() does, and for any other
/// kind of image.
MaskImage read_mask_image(const std::string& path);

}  // namespace disparityd::capture
