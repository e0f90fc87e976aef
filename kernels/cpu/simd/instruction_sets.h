// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hwy/highway.h"

/// Whether the set that is being compiled has vectors: Highway's emulation of them (SCALAR, EMU128), which the
/// compiler's baseline counts as a set, is slower than the reference.
#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)

/// Pointer to `function` as compiled for the instruction set `target` (one bit of hwy::SupportedTargets()), null where
/// the set is not built. To be used under HWY_ONCE, in the namespace around HWY_NAMESPACE.
#define DISPARITYD_FUNCTION_FOR(target, function)           \
    ((target) == HWY_AVX3_DL ? HWY_CHOOSE_AVX3_DL(function) \
     : (target) == HWY_AVX3  ? HWY_CHOOSE_AVX3(function)    \
     : (target) == HWY_AVX2  ? HWY_CHOOSE_AVX2(function)    \
     : (target) == HWY_SSE4  ? HWY_CHOOSE_SSE4(function)    \
     : (target) == HWY_NEON  ? HWY_CHOOSE_NEON(function)    \
                             : nullptr)
