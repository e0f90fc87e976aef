// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/image.h"
#include "kernels/raw_image.h"

namespace disparityd::pipeline {

/// Both eyes as the camera sent them, before rectification, in grey. Empty planes where nobody asked for them.
struct RawEyes {
    Plane<std::uint8_t> left;
    Plane<std::uint8_t> right;
};

/// Fills both planes, which have the size of an eye, with the luma of what was captured, as step 1 of docs/algorithm.md
/// has it. Allocates nothing.
void copy_luma(const RawImage& image, const RawEyes& to);

}  // namespace disparityd::pipeline
