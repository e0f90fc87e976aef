// SPDX-License-Identifier: Apache-2.0
// Numbers as planes of bits, so that one operation on a register works on a bit of as many pixels as it has bits.
#if defined(DISPARITYD_CPU_POST_BIT_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_BIT_PLANES_INL_H_
#undef DISPARITYD_CPU_POST_BIT_PLANES_INL_H_
#else
#define DISPARITYD_CPU_POST_BIT_PLANES_INL_H_
#endif

#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

using PlaneTag = hn::ScalableTag<std::uint8_t>;
using PlaneBits = hn::Vec<PlaneTag>;

/// The bits of `yes` where those of `bits` are set, else those of `no`.
HWY_INLINE PlaneBits select_bits(PlaneBits bits, PlaneBits yes, PlaneBits no) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    return PlaneBits{_mm512_ternarylogic_epi64(bits.raw, yes.raw, no.raw, 0xca)};
#elif HWY_ARCH_ARM_A64
    return PlaneBits{vbslq_u8(bits.raw, yes.raw, no.raw)};
#else
    return hn::Xor(no, hn::And(bits, hn::Xor(yes, no)));
#endif
}

/// Of three bits: the lower bit of their sum.
HWY_INLINE PlaneBits sum_of_bits(PlaneBits a, PlaneBits b, PlaneBits c) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    return PlaneBits{_mm512_ternarylogic_epi64(a.raw, b.raw, c.raw, 0x96)};
#else
    return hn::Xor(hn::Xor(a, b), c);
#endif
}

/// Of three bits: the upper bit of their sum.
HWY_INLINE PlaneBits carry_of_bits(PlaneBits a, PlaneBits b, PlaneBits c) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    return PlaneBits{_mm512_ternarylogic_epi64(a.raw, b.raw, c.raw, 0xe8)};
#else
    return select_bits(hn::Xor(a, b), c, a);
#endif
}

/// `v` where the bits of `a` and `b` are equal, else 0.
HWY_INLINE PlaneBits where_equal(PlaneBits v, PlaneBits a, PlaneBits b) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    return PlaneBits{_mm512_ternarylogic_epi64(v.raw, a.raw, b.raw, 0x90)};
#else
    return hn::AndNot(hn::Xor(a, b), v);
#endif
}

/// How many of 5 or of 7 bits are set, as a number of three bits.
template <int count>
HWY_INLINE void count_bits(const PlaneBits* bits, PlaneBits* number) {
    const PlaneBits first = sum_of_bits(bits[0], bits[1], bits[2]);
    const PlaneBits first_carry = carry_of_bits(bits[0], bits[1], bits[2]);
    number[0] = sum_of_bits(first, bits[3], bits[4]);
    const PlaneBits second_carry = carry_of_bits(first, bits[3], bits[4]);
    if constexpr (count == 5) {
        number[1] = hn::Xor(first_carry, second_carry);
        number[2] = hn::And(first_carry, second_carry);
    } else {
        static_assert(count == 7);
        const PlaneBits third_carry = carry_of_bits(number[0], bits[5], bits[6]);
        number[0] = sum_of_bits(number[0], bits[5], bits[6]);
        number[1] = sum_of_bits(first_carry, second_carry, third_carry);
        number[2] = carry_of_bits(first_carry, second_carry, third_carry);
    }
}

/// The sum of 5 or of 7 numbers of three bits, as one of six bits. `numbers`: the lowest bits of all, then the next.
template <int count>
HWY_INLINE void add_numbers(const PlaneBits (&numbers)[3][count], PlaneBits* sum) {
    PlaneBits ones[3];
    PlaneBits twos[3];
    PlaneBits fours[3];
    count_bits<count>(numbers[0], ones);
    count_bits<count>(numbers[1], twos);
    count_bits<count>(numbers[2], fours);
    sum[0] = ones[0];
    sum[1] = hn::Xor(ones[1], twos[0]);
    const PlaneBits four = hn::And(ones[1], twos[0]);
    const PlaneBits third = sum_of_bits(ones[2], twos[1], fours[0]);
    const PlaneBits eight = carry_of_bits(ones[2], twos[1], fours[0]);
    sum[2] = hn::Xor(third, four);
    const PlaneBits second_eight = hn::And(third, four);
    const PlaneBits fourth = sum_of_bits(twos[2], fours[1], eight);
    const PlaneBits sixteen = carry_of_bits(twos[2], fours[1], eight);
    sum[3] = hn::Xor(fourth, second_eight);
    const PlaneBits second_sixteen = hn::And(fourth, second_eight);
    sum[4] = sum_of_bits(fours[2], sixteen, second_sixteen);
    sum[5] = carry_of_bits(fours[2], sixteen, second_sixteen);
}

template <int distance>
HWY_INLINE void exchange_bits(PlaneBits& a, PlaneBits& b, std::uint16_t mask) {
    const hn::Repartition<std::uint16_t, PlaneTag> words;
    const auto upper = hn::BitCast(words, a);
    const auto lower = hn::BitCast(words, b);
    const auto change = hn::And(hn::Xor(hn::ShiftRight<distance>(upper), lower), hn::Set(words, mask));
    a = hn::BitCast(PlaneTag(), hn::Xor(upper, hn::ShiftLeft<distance>(change)));
    b = hn::BitCast(PlaneTag(), hn::Xor(lower, change));
}

/// Bit i of v[k] becomes bit k of v[i], for each byte of eight registers: bytes become planes, and planes bytes.
HWY_INLINE void transpose_bits(PlaneBits (&v)[8]) {
    DISPARITYD_UNROLL
    for (int i = 0; i < 4; ++i) {
        exchange_bits<4>(v[i], v[i + 4], 0x0f0f);
    }
    DISPARITYD_UNROLL
    for (int i = 0; i < 4; ++i) {
        exchange_bits<2>(v[i + i / 2 * 2], v[i + i / 2 * 2 + 2], 0x3333);
    }
    DISPARITYD_UNROLL
    for (int i = 0; i < 8; i += 2) {
        exchange_bits<1>(v[i], v[i + 1], 0x5555);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
