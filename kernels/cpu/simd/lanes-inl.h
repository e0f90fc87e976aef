// SPDX-License-Identifier: Apache-2.0
// What Highway 1.0.3 has no operation for: moving bytes by one lane through a whole register, and the least byte of a
// register in all its lanes. No include guard by name: Highway includes this file once for each instruction set.
#if defined(DISPARITYD_CPU_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_LANES_INL_H_
#undef DISPARITYD_CPU_SIMD_LANES_INL_H_
#else
#define DISPARITYD_CPU_SIMD_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

// For loops over registers and over rows: left to themselves, compilers keep some of them, and what they index is then
// in memory instead of registers.
#define DISPARITYD_UNROLL _Pragma("GCC unroll 16")

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr bool many_registers = HWY_ARCH_ARM_A64 != 0 || HWY_TARGET <= HWY_AVX3;  // 32, not 16

/// 0, 1, 2, .. for the lanes of the largest register.
template <class T>
struct LaneNumbers {
    alignas(64) T of[64 / sizeof(T)] = {};

    constexpr LaneNumbers() {
        for (std::size_t i = 0; i < 64 / sizeof(T); ++i) {
            of[i] = static_cast<T>(i);
        }
    }
};
template <class T>
inline constexpr LaneNumbers<T> lane_numbers;

/// first, first + 1, .. in the lanes. Highway's Iota() writes the numbers to memory and loads them again each time.
template <class Tag>
HWY_INLINE hn::Vec<Tag> numbers_from(Tag tag, hn::TFromD<Tag> first) {
    return hn::Add(hn::Load(tag, lane_numbers<hn::TFromD<Tag>>.of), hn::Set(tag, first));
}

/// Lane i gets lane i - 1 of `v`; lane 0 gets the last lane of `edge`.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V from_lane_below(Tag tag, V v, V edge) {
    constexpr std::size_t lane_bytes = sizeof(hn::TFromD<Tag>);
    constexpr std::size_t bytes = lane_bytes * hn::MaxLanes(Tag());
    if constexpr (bytes == 16) {
        return hn::CombineShiftRightBytes<16 - lane_bytes>(tag, v, edge);
    } else if constexpr (bytes == 32) {
        return hn::CombineShiftRightBytes<16 - lane_bytes>(tag, v, hn::ConcatLowerUpper(tag, v, edge));
    } else {
#if HWY_TARGET <= HWY_AVX3
        return hn::CombineShiftRightBytes<16 - lane_bytes>(tag, v, V{_mm512_alignr_epi64(v.raw, edge.raw, 6)});
#endif
    }
}

/// The same where all lanes of `edge` are alike.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V from_lane_below_or_all(Tag tag, V v, V edge) {
#if HWY_TARGET <= HWY_AVX3
    if constexpr (sizeof(hn::TFromD<Tag>) == 2 && hn::MaxLanes(Tag()) == 32) {
        const V below = numbers_from(tag, std::uint16_t{0xffff});
        return V{_mm512_mask_permutexvar_epi16(edge.raw, ~__mmask32{1}, below.raw, v.raw)};
    }
#endif
    return from_lane_below(tag, v, edge);
}

/// Lane i gets lane i + 1 of `v`; the last lane gets lane 0 of `edge`.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V from_lane_above(Tag tag, V v, V edge) {
    constexpr std::size_t lane_bytes = sizeof(hn::TFromD<Tag>);
    constexpr std::size_t bytes = lane_bytes * hn::MaxLanes(Tag());
    if constexpr (bytes == 16) {
        return hn::CombineShiftRightBytes<lane_bytes>(tag, edge, v);
    } else if constexpr (bytes == 32) {
        return hn::CombineShiftRightBytes<lane_bytes>(tag, hn::ConcatLowerUpper(tag, edge, v), v);
    } else {
#if HWY_TARGET <= HWY_AVX3
        return hn::CombineShiftRightBytes<lane_bytes>(tag, V{_mm512_alignr_epi64(edge.raw, v.raw, 2)}, v);
#endif
    }
}

#if HWY_TARGET == HWY_AVX3_DL
/// For each lane the one `distance` after it, or the last there is.
template <int lanes, int distance>
struct LanesMoved {
    alignas(64) std::uint8_t from[lanes] = {};

    constexpr LanesMoved() {
        for (int i = 0; i < lanes; ++i) {
            const int source = i + distance;
            from[i] = static_cast<std::uint8_t>(source < 0 ? 0 : source < lanes ? source : lanes - 1);
        }
    }
};
template <int lanes, int distance>
inline constexpr LanesMoved<lanes, distance> lanes_moved;

/// Byte i is byte from[i] of `v`, a whole vector of more than one block; `from` is aligned like it.
template <class V>
HWY_INLINE V permuted(V v, const std::uint8_t* from) {
    if constexpr (sizeof(v.raw) == 64) {
        return V{_mm512_permutexvar_epi8(_mm512_load_si512(from), v.raw)};
    } else {
        static_assert(sizeof(v.raw) == 32);
        return V{_mm256_permutexvar_epi8(_mm256_load_si256(reinterpret_cast<const __m256i*>(from)), v.raw)};
    }
}

/// Lanes past an end stay what they are.
template <int distance, class V>
HWY_INLINE V move_lanes(V v) {
    return permuted(v, lanes_moved<sizeof(v.raw), distance>.from);
}
#endif

/// For the neighbours of a path's lanes: like from_lane_below, with 255 beyond the end. With one or two registers per
/// pixel the first lane may as well be its own neighbour (a neighbour costs a penalty more), which saves an operation.
template <int registers, class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V path_from_below(Tag tag, V v, V none) {
#if HWY_TARGET == HWY_AVX3_DL
    if constexpr (hn::MaxLanes(Tag()) > 16) {
        const V moved = move_lanes<-1>(v);
        return registers <= 2 ? moved : hn::IfThenElse(hn::FirstN(tag, 1), none, moved);
    }
#endif
    return from_lane_below(tag, v, none);
}

template <int registers, class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V path_from_above(Tag tag, V v, V none) {
#if HWY_TARGET == HWY_AVX3_DL
    if constexpr (hn::MaxLanes(Tag()) > 16) {
        const V moved = move_lanes<1>(v);
        return registers <= 2 ? moved : hn::IfThenElse(hn::FirstN(tag, hn::MaxLanes(Tag()) - 1), moved, none);
    }
#endif
    return from_lane_above(tag, v, none);
}

/// What is at `from` in all lanes, from memory: GCC likes to take it through a general register, which costs double.
template <class Tag>
HWY_INLINE hn::Vec<Tag> broadcast(Tag tag, const hn::TFromD<Tag>* from) {
#if HWY_COMPILER_GCC_ACTUAL && HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    (void)tag;
    hn::Vec<Tag> v;
    if constexpr (sizeof(*from) == 1) {
        __asm__("vpbroadcastb %1, %0" : "=v"(v.raw) : "m"(*from));
    } else {
        static_assert(sizeof(*from) == 2);
        __asm__("vpbroadcastw %1, %0" : "=v"(v.raw) : "m"(*from));
    }
    return v;
#else
    return hn::Set(tag, *from);
#endif
}

/// `v`, from here on in a register of its own: GCC repeats a load for each use that can have it as an operand, where
/// loads are what is scarce, and copies what a loop adds up from register to register.
template <class V>
HWY_INLINE V in_register(V v) {
#if HWY_COMPILER_GCC_ACTUAL && HWY_ARCH_X86
    __asm__("" : "+v"(v.raw));
#endif
    return v;
}

/// How many bytes after `v` the `next` of bytes_between() is loaded.
constexpr int bytes_to_next = HWY_TARGET == HWY_AVX3_DL ? 4 : 16;

/// What a load 1, 2 or 3 `bytes` after that of `v` would give, in one operation.
template <int bytes, class V>
HWY_INLINE V bytes_between(V v, V next) {
#if HWY_TARGET == HWY_AVX3_DL
    if constexpr (sizeof(v.raw) == 64) {
        return V{_mm512_shrdi_epi32(v.raw, next.raw, 8 * bytes)};
    } else if constexpr (sizeof(v.raw) == 32) {
        return V{_mm256_shrdi_epi32(v.raw, next.raw, 8 * bytes)};
    } else {
        return V{_mm_shrdi_epi32(v.raw, next.raw, 8 * bytes)};
    }
#else
    return hn::CombineShiftRightBytes<bytes>(hn::DFromV<V>(), next, v);
#endif
}

/// The least byte of 16, in all lanes of `tag`.
template <class Tag, class Block>
HWY_INLINE hn::Vec<Tag> broadcast_least_of_block(Tag tag, Block block) {
    const hn::FixedTag<std::uint8_t, 16> block_tag;
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
    const hn::Repartition<std::uint16_t, decltype(block_tag)> pairs;
    const auto min_of_pair = hn::Min(block, hn::BitCast(block_tag, hn::ShiftRight<8>(hn::BitCast(pairs, block))));
    const __m128i least = _mm_minpos_epu16(min_of_pair.raw);
    if constexpr (hn::MaxLanes(Tag()) == 16) {
        return hn::Vec<Tag>{_mm_shuffle_epi8(least, _mm_setzero_si128())};
    }
#if HWY_TARGET <= HWY_AVX2
    if constexpr (hn::MaxLanes(Tag()) == 32) {
        return hn::Vec<Tag>{_mm256_broadcastb_epi8(least)};
    }
#endif
#if HWY_TARGET <= HWY_AVX3
    if constexpr (hn::MaxLanes(Tag()) == 64) {
        return hn::Vec<Tag>{_mm512_broadcastb_epi8(least)};
    }
#endif
#elif HWY_ARCH_ARM_A64
    (void)block_tag;
    return hn::Set(tag, vminvq_u8(block.raw));
#else
    block = hn::Min(block, hn::ShiftRightBytes<8>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<4>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<2>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<1>(block_tag, block));
    return hn::Set(tag, hn::GetLane(block));
#endif
}

#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
/// Bytes of `v` times signed bytes of `factors`, the products of each pair added.
template <class Words, class V>
HWY_INLINE hn::Vec<Words> multiply_add_bytes(Words, V v, hn::Vec<Words> factors) {
    if constexpr (sizeof(v.raw) == 16) {
        return hn::Vec<Words>{_mm_maddubs_epi16(v.raw, factors.raw)};
    }
#if HWY_TARGET <= HWY_AVX2
    if constexpr (sizeof(v.raw) == 32) {
        return hn::Vec<Words>{_mm256_maddubs_epi16(v.raw, factors.raw)};
    }
#endif
#if HWY_TARGET <= HWY_AVX3
    if constexpr (sizeof(v.raw) == 64) {
        return hn::Vec<Words>{_mm512_maddubs_epi16(v.raw, factors.raw)};
    }
#endif
}
#endif

/// The even (or the odd) bytes of `v` as words.
template <bool odd, class Words, class V>
HWY_INLINE hn::Vec<Words> words_of_bytes(Words words, V v) {
    const auto pairs = hn::BitCast(words, v);
    return odd ? hn::ShiftRight<8>(pairs) : hn::And(pairs, hn::Set(words, std::uint16_t{0x00ff}));
}

/// 2^shift times the even (or the odd) bytes of `v`, as words; shift is at most 6.
template <bool odd, int shift, class Words, class V>
HWY_INLINE hn::Vec<Words> shifted_bytes(Words words, V v) {
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
    return multiply_add_bytes(words, v, hn::Set(words, std::uint16_t{(odd ? 256 : 1) << shift}));
#else
    return hn::ShiftLeft<shift>(words_of_bytes<odd>(words, v));
#endif
}

/// 2^shift times the sum of the even (or the odd) bytes of `a` and `b`, as words; shift is at most 6.
template <bool odd, int shift, class Words, class V>
HWY_INLINE hn::Vec<Words> sum_of_bytes(Words words, V a, V b) {
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
    return hn::Add(shifted_bytes<odd, shift>(words, a), shifted_bytes<odd, shift>(words, b));
#else
    return hn::ShiftLeft<shift>(hn::Add(words_of_bytes<odd>(words, a), words_of_bytes<odd>(words, b)));
#endif
}

/// 2^shift times what each even byte of `v` is more than the odd byte after it; shift is at most 6.
template <int shift, class Words, class V>
HWY_INLINE hn::Vec<Words> difference_of_bytes(Words words, V v) {
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
    return multiply_add_bytes(words, v, hn::Set(words, std::uint16_t{((256 - (1 << shift)) << 8) | (1 << shift)}));
#else
    return hn::ShiftLeft<shift>(hn::Sub(words_of_bytes<false>(words, v), words_of_bytes<true>(words, v)));
#endif
}

/// |a - b| of bytes.
template <class V>
HWY_INLINE V absolute_difference(V a, V b) {
#if HWY_ARCH_ARM_A64
    return V{vabdq_u8(a.raw, b.raw)};
#elif HWY_TARGET <= HWY_AVX3
    return hn::Sub(hn::Max(a, b), hn::Min(a, b));  // of 512 bits, each of them takes half of what SaturatedSub() takes
#else
    return hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
#endif
}

/// v + bytes where the mask is set, v elsewhere.
template <class Mask, class V>
HWY_INLINE V add_where(Mask mask, V v, V bytes) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    if constexpr (sizeof(v.raw) == 64) {
        return V{_mm512_mask_add_epi8(v.raw, mask.raw, v.raw, bytes.raw)};
    } else
#endif
    {
        return hn::Add(v, hn::IfThenElseZero(mask, bytes));
    }
}

/// The last 128-bit block of `v`.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE auto last_block(Tag tag, V v) {
    if constexpr (sizeof(hn::TFromD<Tag>) * hn::MaxLanes(Tag()) == 16) {
        (void)tag;
        return v;
    } else {
        const hn::Half<Tag> half;
        return last_block(half, hn::UpperHalf(half, v));
    }
}

/// Min of the 128-bit blocks of `v`: one block.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE auto min_of_blocks(Tag tag, V v) {
    if constexpr (sizeof(hn::TFromD<Tag>) * hn::MaxLanes(Tag()) == 16) {
        (void)tag;
        return v;
    } else {
        const hn::Half<Tag> half;
        return min_of_blocks(half, hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
    }
}

/// The least byte of `v` in all lanes.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V broadcast_min(Tag tag, V v) {
    return broadcast_least_of_block(tag, min_of_blocks(tag, v));
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
