// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/steps.h"

namespace disparityd::lab {

/// Naive code as the paper describes it (section 3.1), not vectorised: the reference, but windows are summed and census
/// words made anew for every candidate. Its census steps hand pixels on as words.
const KernelSteps& steps_as_described();

}  // namespace disparityd::lab
