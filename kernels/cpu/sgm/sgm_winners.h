// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm/sgm_kernels.h"

namespace disparityd::cpu {

using SgmWinner = decltype(SgmKernels::winner);

/// SgmKernels::winner of sgm_kernels(); null where the instruction set has none.
SgmWinner sgm_winner(std::int64_t target, int disparities);

}  // namespace disparityd::cpu
