// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/step_kernels.h"

#include "kernels/cpu/rectify/rectify_kernels.h"
#include "kernels/reference/steps.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/step_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/cost/smooth-inl.h"
#include "kernels/cpu/post/depth_error-inl.h"
#include "kernels/cpu/post/guided_median-inl.h"
#include "kernels/cpu/post/interpolate-inl.h"
#include "kernels/cpu/post/left_right-inl.h"
#include "kernels/cpu/post/median-inl.h"
#include "kernels/cpu/post/outputs-inl.h"
#include "kernels/cpu/post/shrink-inl.h"
#include "kernels/cpu/post/speckle-inl.h"
#include "kernels/cpu/post/vote-inl.h"
#include "kernels/cpu/scan/scan_counts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

const FrameSteps& frame_steps() {
    static const RectifyKernels rectify = rectify_kernels(HWY_TARGET);
    static const FrameSteps table = {
        .rectify = rectify.luma,
        .rectify_colour = rectify.colour,
        .smooth = smooth,
        .left_right = left_right,
        .median = median,
        .vote = vote,
        .speckle = speckle,
        .speckle_scratch = speckle_scratch,
        .finish_confidence = finish_confidence,
        .interpolate = interpolate,
        .interpolate_scratch = interpolate_scratch,
        .guided_median = guided_median,
        .depth = depth,
        .depth_error = depth_error,
        .shrink = shrink,
        .scan_counts = scan_counts,
    };
    return table;
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

const FrameSteps& frame_steps(std::int64_t target) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, frame_steps);
    return built != nullptr ? built() : reference::steps.frame;
}

}  // namespace disparityd::cpu
#endif
