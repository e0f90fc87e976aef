// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/steps.h"

namespace disparityd::cpu {

/// The table of steps for an instruction set of Highway: the reference's functions, and vectorised ones where there are
/// (median).
const KernelSteps& steps(std::int64_t target);

}  // namespace disparityd::cpu
