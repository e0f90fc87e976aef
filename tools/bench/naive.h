// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/steps.h"

namespace disparityd::bench {

/// The plain code that ours is compared with, from the same sources.
enum class Build : std::uint8_t {
    as_compiled,     ///< with the flags of the project: the compiler makes vector code where it can
    not_vectorised,  ///< with the compiler's vectorisers switched off
};

/// The reference.
const KernelSteps& naive_steps(Build build);

}  // namespace disparityd::bench
