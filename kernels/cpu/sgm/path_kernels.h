// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/options.h"

namespace disparityd::cpu {

/// Whether sums of the paths of one sweep are words; bytes else.
bool sums_need_u16(const SgmOptions& options);

/// The kernels that the options ask for, of sgm_kernels() or of those below; those of AVX2 where they are not built for
/// `target`, and nothing (no lanes) where not for AVX2 either.
SgmKernels path_kernels(std::int64_t target, const MatchOptions& options);

/// 8 paths, any P2. Like the next two: nothing (no lanes) where they are not built for `target`.
SgmKernels u16_sum_kernels(std::int64_t target, int disparities);

/// 4 paths, P2 up to max_byte_p2.
SgmKernels four_path_kernels(std::int64_t target, int disparities);
/// 4 paths, any P2.
SgmKernels four_path_u16_sum_kernels(std::int64_t target, int disparities);

}  // namespace disparityd::cpu
