// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/rectify_kernels.h"

#include "kernels/reference/steps.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/rectify_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/rectify-inl.h"
#include "kernels/cpu/rectify_colour-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

void rectify(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows) {
    switch (raw.format) {
        case PixelFormat::grey8: rectify_from<PixelFormat::grey8>(raw, eye, rectifier, out, rows); break;
        case PixelFormat::yuyv: rectify_from<PixelFormat::yuyv>(raw, eye, rectifier, out, rows); break;
        case PixelFormat::bgr24: reference::rectify(raw, eye, rectifier, out, rows); break;  // image files: no camera
    }
}

void rectify_colour(const RawImage& raw, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows) {
    if (raw.format == PixelFormat::yuyv) {
        rectify_yuyv_colour(raw, rectifier, bgr, rows);
    } else {
        reference::rectify_colour(raw, rectifier, bgr, rows);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

RectifyKernels rectify_kernels(std::int64_t target) {
    switch (target) {
#if HWY_TARGETS & HWY_AVX3_DL
        case HWY_AVX3_DL: return {N_AVX3_DL::rectify, N_AVX3_DL::rectify_colour};
#endif
#if HWY_TARGETS & HWY_AVX3
        case HWY_AVX3: return {N_AVX3::rectify, N_AVX3::rectify_colour};
#endif
#if HWY_TARGETS & HWY_AVX2
        case HWY_AVX2: return {N_AVX2::rectify, N_AVX2::rectify_colour};
#endif
#if HWY_TARGETS & HWY_SSE4
        case HWY_SSE4: return {N_SSE4::rectify, N_SSE4::rectify_colour};
#endif
#if HWY_TARGETS & HWY_NEON
        case HWY_NEON: return {N_NEON::rectify, N_NEON::rectify_colour};
#endif
        default: return {reference::rectify, reference::rectify_colour};
    }
}

}  // namespace disparityd::cpu
#endif
