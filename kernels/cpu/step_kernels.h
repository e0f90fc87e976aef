// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/steps.h"

namespace disparityd::cpu {

/// The table of steps for an instruction set of Highway. What comes before and after matching is vectorised
/// (rectify_colour is not); census to extrema are the reference's functions, for options without a matcher of their
/// own.
const KernelSteps& steps(std::int64_t target);

}  // namespace disparityd::cpu
