// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

/// The depth of step 13 in millimetres.
inline __device__ std::uint16_t depth_of(const DepthJob& scale, std::int16_t invalid, std::int16_t disparity) {
    if (disparity == invalid || scale.k == 0) {
        return 0;
    }
    const std::int64_t d = std::int64_t{disparity} + scale.offset16;
    const std::int64_t millimetres = d <= 0 ? 65535 : (scale.k + d / 2) / d;
    return static_cast<std::uint16_t>(millimetres < 1 ? 1 : millimetres > 65535 ? 65535 : millimetres);
}

}  // namespace disparityd::cuda
