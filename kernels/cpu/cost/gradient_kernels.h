// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm/sgm_kernels.h"

namespace disparityd::cpu {

/// Puts the census and the costs of census-7x5+gradient into `kernels`, which are those of this instruction set and
/// number of candidates. Without kernels for it (no lanes) nothing changes.
void use_gradient_cost(std::int64_t target, int disparities, SgmKernels& kernels);

}  // namespace disparityd::cpu
