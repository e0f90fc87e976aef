// SPDX-License-Identifier: Apache-2.0
// Which layout of candidates (see DisparityLayout) an instruction set has for a number of disparities.
#if defined(DISPARITYD_CPU_SIMD_LAYOUTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_LAYOUTS_INL_H_
#undef DISPARITYD_CPU_SIMD_LAYOUTS_INL_H_
#else
#define DISPARITYD_CPU_SIMD_LAYOUTS_INL_H_
#endif

#include <type_traits>

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <int value>
using Constant = std::integral_constant<int, value>;

/// Calls use(tag, registers), registers a Constant, and returns what it returns. With many registers per pixel not
/// every number is compiled: the next larger one serves.
template <class Tag, class Use>
auto with_registers(Tag tag, int registers, Use use) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    switch (registers) {
        case 1: return use(tag, Constant<1>());
        case 2: return use(tag, Constant<2>());
        case 3: return use(tag, Constant<3>());
        case 4: return use(tag, Constant<4>());
        default: break;
    }
    if constexpr (lanes <= 16) {
        if (registers > 12) {
            return use(tag, Constant<16>());
        }
        if (registers > 8) {
            return registers <= 10 ? use(tag, Constant<10>()) : use(tag, Constant<12>());
        }
    }
    if constexpr (lanes == 32) {
        if (registers == 5) {
            return use(tag, Constant<5>());
        }
    }
    if constexpr (lanes <= 32) {
        return registers <= 6 ? use(tag, Constant<6>()) : use(tag, Constant<8>());
    } else {
        return use(tag, Constant<4>());
    }
}

/// Few disparities use a part of a register only. So do up to 96: three registers of 32 lanes take no longer than two
/// of 64, and less memory. Five for up to 160 were slower than three of 64.
template <class Use>
auto with_layout(int disparities, Use use) {
    const hn::CappedTag<std::uint8_t, 16> sixteen;
    const hn::CappedTag<std::uint8_t, 32> thirty_two;
    const hn::ScalableTag<std::uint8_t> whole;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(whole));
    if constexpr (lanes > 16) {
        if (disparities <= 16) {
            return use(sixteen, Constant<1>());
        }
    }
    if constexpr (lanes > 32) {
        if (disparities <= 32) {
            return use(thirty_two, Constant<1>());
        }
        if (disparities > 64 && disparities <= 96) {
            return use(thirty_two, Constant<3>());
        }
    }
    return with_registers(whole, (disparities + lanes - 1) / lanes, use);
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
