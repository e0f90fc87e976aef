// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/naive.h"

#include "kernels/reference/steps.h"

// Made by renamed_reference.h.
namespace disparityd::reference_not_vectorised {
extern const KernelSteps steps;
}

namespace disparityd::bench {

const KernelSteps& naive_steps(Build build) {
    return build == Build::as_compiled ? reference::steps : reference_not_vectorised::steps;
}

}  // namespace disparityd::bench
