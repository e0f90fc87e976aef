// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/rectify/rectify_kernels.h"

#include "kernels/reference/steps.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/rectify/rectify_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/rectify/rectify-inl.h"
#include "kernels/cpu/rectify/rectify_colour-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

void rectify(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows) {
    switch (raw.format) {
        case PixelFormat::grey8: rectify_from<PixelFormat::grey8>(raw, eye, rectifier, out, rows); break;
        case PixelFormat::yuyv: rectify_from<PixelFormat::yuyv>(raw, eye, rectifier, out, rows); break;
        case PixelFormat::bgr24: reference::rectify(raw, eye, rectifier, out, rows); break;  // image files: no camera
    }
}

void rectify_colour(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows) {
    if (raw.format == PixelFormat::yuyv) {
        rectify_yuyv_colour(raw, eye, rectifier, bgr, rows);
    } else {
        reference::rectify_colour(raw, eye, rectifier, bgr, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

RectifyKernels rectify_kernels(std::int64_t target) {
    const auto luma = DISPARITYD_FUNCTION_FOR(target, rectify);
    const auto colour = DISPARITYD_FUNCTION_FOR(target, rectify_colour);
    return luma != nullptr ? RectifyKernels{luma, colour}
                           : RectifyKernels{reference::rectify, reference::rectify_colour};
}

}  // namespace disparityd::cpu
#endif
