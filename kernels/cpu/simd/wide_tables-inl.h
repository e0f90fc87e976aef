// SPDX-License-Identifier: Apache-2.0
// What AVX-512 with VBMI has and Highway 1.0.3 has not: looking up bytes anywhere in a whole register, or in two.
#if defined(DISPARITYD_CPU_SIMD_WIDE_TABLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_WIDE_TABLES_INL_H_
#undef DISPARITYD_CPU_SIMD_WIDE_TABLES_INL_H_
#else
#define DISPARITYD_CPU_SIMD_WIDE_TABLES_INL_H_
#endif

#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX3_DL
using WideBytes = hn::Vec<hn::ScalableTag<std::uint8_t>>;

/// Of 64 bytes; the upper two bits of an index do not matter.
HWY_INLINE WideBytes look_up(WideBytes table, WideBytes index) {
    return WideBytes{_mm512_permutexvar_epi8(index.raw, table.raw)};
}

/// Of 128 bytes; the upper bit of an index does not matter.
HWY_INLINE WideBytes look_up(WideBytes lower, WideBytes upper, WideBytes index) {
    return WideBytes{_mm512_permutex2var_epi8(lower.raw, index.raw, upper.raw)};
}
#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
