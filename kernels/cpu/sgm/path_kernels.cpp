// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/path_kernels.h"

#include "hwy/targets.h"
#include "kernels/cpu/cost/gradient_kernels.h"

namespace disparityd::cpu {

namespace {

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
    SgmKernels kernels = kernels_of_variant(target, disparities, eight_paths, words);
    if (kernels.layout.lanes == 0) {
        target = HWY_AVX2;
        kernels = kernels_of_variant(target, disparities, eight_paths, words);
    }
    use_cost(options.cost, target, disparities, kernels);
    return kernels;
}

}  // namespace disparityd::cpu
