// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/path_kernels.h"

#include "hwy/targets.h"

namespace disparityd::cpu {

namespace {

// With sums in words, memory allows for half as many candidates again as padding, no more: 80 in two registers of 64
// have more, in three of 32 they have less.
std::int64_t target_for_words(std::int64_t target, int disparities) {
    const bool much_padding = 2 * sgm_kernels(target, disparities).layout.candidates() > 3 * disparities;
    const bool other_there = sgm_kernels(HWY_AVX2, disparities).layout.lanes != 0;
    return much_padding && other_there ? HWY_AVX2 : target;
}

}  // namespace

SgmKernels path_kernels(std::int64_t target, DisparityRange range, const SgmOptions& options) {
    const bool eight = options.paths == 8;
    if (options.p2 <= (eight ? max_byte_p2 : max_byte_p2_of_4_paths)) {
        return eight ? sgm_kernels(target, range.count) : four_path_kernels(target, range.count);
    }
    const std::int64_t wide_target = target_for_words(target, range.count);
    return eight ? wide_kernels(wide_target, range.count) : wide_four_path_kernels(wide_target, range.count);
}

}  // namespace disparityd::cpu
