// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/steps.h"

namespace disparityd::cpu {

/// Step 1 for an instruction set of Highway, as FrameSteps has it.
struct RectifyKernels {
    void (*luma)(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows);
    void (*colour)(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows);
};

RectifyKernels rectify_kernels(std::int64_t target);

}  // namespace disparityd::cpu
