// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/path_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/sgm/four_path_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/sgm/variant_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

inline SgmKernels four_path_kernels_of(int disparities, const SgmKernels& kernels) {
    return for_variant<four_paths_u8_sums>(disparities, kernels);
}

inline SgmKernels four_path_u16_sum_kernels_of(int disparities, const SgmKernels& kernels) {
    return for_variant<four_paths_u16_sums>(disparities, kernels);
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

SgmKernels four_path_kernels(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, four_path_kernels_of);
    return built != nullptr ? built(disparities, sgm_kernels(target, disparities)) : SgmKernels{};
}

SgmKernels four_path_u16_sum_kernels(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, four_path_u16_sum_kernels_of);
    return built != nullptr ? built(disparities, sgm_kernels(target, disparities)) : SgmKernels{};
}

}  // namespace disparityd::cpu
#endif
