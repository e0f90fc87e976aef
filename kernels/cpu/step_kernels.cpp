// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/step_kernels.h"

#include "kernels/cpu/rectify_kernels.h"
#include "kernels/reference/steps.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/step_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/interpolate-inl.h"
#include "kernels/cpu/left_right-inl.h"
#include "kernels/cpu/median-inl.h"
#include "kernels/cpu/outputs-inl.h"
#include "kernels/cpu/speckle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

const KernelSteps& steps() {
    static const KernelSteps table = [] {
        KernelSteps changed = reference::steps;
        const RectifyKernels rectify = rectify_kernels(HWY_TARGET);
        changed.rectify = rectify.luma;
        changed.rectify_colour = rectify.colour;
        changed.left_right = left_right;
        changed.median = median;
        changed.speckle = speckle;
        changed.speckle_scratch = speckle_scratch;
        changed.mask_confidence = mask_confidence;
        changed.interpolate = interpolate;
        changed.interpolate_scratch = interpolate_scratch;
        changed.depth = depth;
        return changed;
    }();
    return table;
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

const KernelSteps& steps(std::int64_t target) {
    switch (target) {
#if HWY_TARGETS & HWY_AVX3_DL
        case HWY_AVX3_DL: return N_AVX3_DL::steps();
#endif
#if HWY_TARGETS & HWY_AVX3
        case HWY_AVX3: return N_AVX3::steps();
#endif
#if HWY_TARGETS & HWY_AVX2
        case HWY_AVX2: return N_AVX2::steps();
#endif
#if HWY_TARGETS & HWY_SSE4
        case HWY_SSE4: return N_SSE4::steps();
#endif
#if HWY_TARGETS & HWY_NEON
        case HWY_NEON: return N_NEON::steps();
#endif
        default: return reference::steps;
    }
}

}  // namespace disparityd::cpu
#endif
