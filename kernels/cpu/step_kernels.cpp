// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/step_kernels.h"

#include "kernels/cpu/rectify_kernels.h"
#include "kernels/reference/steps.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/step_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/instruction_sets.h"

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
    const auto built = DISPARITYD_FUNCTION_FOR(target, steps);
    return built != nullptr ? built() : reference::steps;
}

}  // namespace disparityd::cpu
#endif
