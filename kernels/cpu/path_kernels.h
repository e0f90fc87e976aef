// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm_kernels.h"
#include "kernels/options.h"

namespace disparityd::cpu {

/// The kernels that the options ask for, of sgm_kernels() or of those below. Nothing (no lanes) where an instruction
/// set is not built.
SgmKernels path_kernels(std::int64_t target, DisparityRange range, const SgmOptions& options);

/// 8 paths, any P2.
SgmKernels wide_kernels(std::int64_t target, int disparities);

/// 4 paths, P2 up to max_byte_p2_of_4_paths.
SgmKernels four_path_kernels(std::int64_t target, int disparities);
/// 4 paths, any P2.
SgmKernels wide_four_path_kernels(std::int64_t target, int disparities);

/// The largest P2 for which sums of two paths fit a byte (2 * 127 = 254).
constexpr int max_byte_p2_of_4_paths = 127;

}  // namespace disparityd::cpu
