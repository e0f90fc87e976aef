// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/steps.h"

namespace disparityd::cpu {

/// For an instruction set of Highway.
const FrameSteps& frame_steps(std::int64_t target);

}  // namespace disparityd::cpu
