// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/path_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/wide_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
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
    const SgmKernels kernels = sgm_kernels(target, disparities);
    switch (target) {
#if HWY_TARGETS & HWY_AVX3_DL
        case HWY_AVX3_DL: return N_AVX3_DL::wide_kernels_of(disparities, kernels);
#endif
#if HWY_TARGETS & HWY_AVX3
        case HWY_AVX3: return N_AVX3::wide_kernels_of(disparities, kernels);
#endif
#if HWY_TARGETS & HWY_AVX2
        case HWY_AVX2: return N_AVX2::wide_kernels_of(disparities, kernels);
#endif
#if HWY_TARGETS & HWY_SSE4
        case HWY_SSE4: return N_SSE4::wide_kernels_of(disparities, kernels);
#endif
#if HWY_TARGETS & HWY_NEON
        case HWY_NEON: return N_NEON::wide_kernels_of(disparities, kernels);
#endif
        default: return {};
    }
}

}  // namespace disparityd::cpu
#endif
