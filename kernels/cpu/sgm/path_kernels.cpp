// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/path_kernels.h"

#include "hwy/targets.h"
#include "kernels/cpu/cost/gradient_kernels.h"

namespace disparityd::cpu {

namespace {

// With sums in words, memory allows for half as many candidates again as padding, no more: 80 in two registers of 64
// have more, in three of 32 they have less.
std::int64_t target_for_words(std::int64_t target, int disparities) {
    const bool much_padding = 2 * sgm_kernels(target, disparities).layout.candidates() > 3 * disparities;
    const bool other_there = sgm_kernels(HWY_AVX2, disparities).layout.lanes != 0;
    return much_padding && other_there ? HWY_AVX2 : target;
}

SgmKernels kernels_of_variant(std::int64_t target, int disparities, bool eight_paths, bool words) {
    if (words) {
        return eight_paths ? u16_sum_kernels(target, disparities) : four_path_u16_sum_kernels(target, disparities);
    }
    return eight_paths ? sgm_kernels(target, disparities) : four_path_kernels(target, disparities);
}

}  // namespace

bool sums_need_u16(const SgmOptions& options) {
    return options.p2 > max_byte_p2;
}

SgmKernels path_kernels(std::int64_t target, const MatchOptions& options) {
    const int disparities = options.range.count;
    const bool eight_paths = options.sgm.paths == 8;
    const bool words = sums_need_u16(options.sgm);
    std::int64_t fitting = words ? target_for_words(target, disparities) : target;
    SgmKernels kernels = kernels_of_variant(fitting, disparities, eight_paths, words);
    if (kernels.layout.lanes == 0) {
        fitting = HWY_AVX2;
        kernels = kernels_of_variant(fitting, disparities, eight_paths, words);
    }
    use_cost(options.cost, fitting, disparities, kernels);
    return kernels;
}

}  // namespace disparityd::cpu
