// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/steps.h"

namespace disparityd::cpu {

/// Step 1 for an instruction set of Highway, as KernelSteps has it.
using Rectify = void (*)(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows);
Rectify rectify(std::int64_t target);

}  // namespace disparityd::cpu
