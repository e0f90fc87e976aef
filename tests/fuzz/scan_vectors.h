// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernels/scan_counts.h"

namespace disparityd::fuzz {

/// The vectorised counting of scans, for each instruction set that this machine has and the program is built for.
std::vector<scan::CountPixels*> vectorised_scan_counts();

}  // namespace disparityd::fuzz
