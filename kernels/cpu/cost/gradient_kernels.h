// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm/sgm_kernels.h"

namespace disparityd::cpu {

/// Puts the census and the matching cost of this kind into `kernels`, which are those of this instruction set and
/// number of candidates and have census-9x7. Without kernels for it (no lanes) nothing changes.
void use_cost(CensusCost cost, std::int64_t target, int disparities, SgmKernels& kernels);

}  // namespace disparityd::cpu
