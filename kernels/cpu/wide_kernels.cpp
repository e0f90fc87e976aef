// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/path_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/wide_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/form_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

inline SgmKernels wide_kernels_of(int disparities, const SgmKernels& kernels) {
    return in_form<eight_paths_in_words>(disparities, kernels);
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

SgmKernels wide_kernels(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, wide_kernels_of);
    return built != nullptr ? built(disparities, sgm_kernels(target, disparities)) : SgmKernels{};
}

}  // namespace disparityd::cpu
#endif
