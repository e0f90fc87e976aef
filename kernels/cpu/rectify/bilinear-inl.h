// SPDX-License-Identifier: Apache-2.0
// Step 1 of docs/algorithm.md, the arithmetic: a pixel between four others, in words of 16 bits.
#if defined(DISPARITYD_CPU_RECTIFY_BILINEAR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RECTIFY_BILINEAR_INL_H_
#undef DISPARITYD_CPU_RECTIFY_BILINEAR_INL_H_
#else
#define DISPARITYD_CPU_RECTIFY_BILINEAR_INL_H_
#endif

#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// For each lane ((32-fx)(32-fy) p00 + fx (32-fy) p10 + (32-fx) fy p01 + fx fy p11 + 512) >> 10, where `upper` is
/// p00 + 256 p10, `lower` is p01 + 256 p11 and `fraction` is fy * 32 + fx.
///
/// It fits words: with u and l the sums along x (at most 32 * 255) the numerator is 32 (u + 16) + fy (l - u). The
/// first part is a multiple of 32, so floor(numerator / 32) = u + 16 + floor(fy (l - u) / 32), and the last term is
/// the upper half of the product of 1024 fy and 2 (l - u).
template <class Words, class V = hn::Vec<Words>>
HWY_INLINE V bilinear(Words words, V upper, V lower, V fraction) {
    const hn::RebindToSigned<Words> numbers;
    const V fx = hn::And(fraction, hn::Set(words, std::uint16_t{31}));
    const V fy_1024 = hn::ShiftLeft<5>(hn::And(fraction, hn::Set(words, std::uint16_t{31 * 32})));
    const auto along_x = [&](V pair) {
        const V first = hn::And(pair, hn::Set(words, std::uint16_t{255}));
        return hn::Add(hn::ShiftLeft<5>(first), hn::Mul(fx, hn::Sub(hn::ShiftRight<8>(pair), first)));
    };
    const V u = along_x(upper);
    const V slope = hn::Sub(along_x(lower), u);
    const auto part = hn::MulHigh(hn::BitCast(numbers, fy_1024), hn::BitCast(numbers, hn::Add(slope, slope)));
    return hn::ShiftRight<5>(hn::Add(hn::Add(u, hn::Set(words, std::uint16_t{16})), hn::BitCast(words, part)));
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
