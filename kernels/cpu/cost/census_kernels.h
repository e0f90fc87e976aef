// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm/sgm_kernels.h"

namespace disparityd::cpu {

/// Puts the census of 9 x 7 and its matching cost into `kernels`, which are those of this instruction set and number of
/// candidates. Without kernels for it nothing changes.
void use_census_9x7(std::int64_t target, int disparities, SgmKernels& kernels);

}  // namespace disparityd::cpu
