// SPDX-License-Identifier: Apache-2.0
// Census words from planes of their bits: where the processor counts the bits of whole words, costs are computed from
// these.
#if defined(DISPARITYD_CPU_COST_CENSUS_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_CENSUS_WORDS_INL_H_
#undef DISPARITYD_CPU_COST_CENSUS_WORDS_INL_H_
#else
#define DISPARITYD_CPU_COST_CENSUS_WORDS_INL_H_
#endif

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

#if HWY_TARGET == HWY_AVX3_DL
/// Where byte 16 i + j of a plane comes from so that interleaving within 128-bit blocks brings the words of pixels
/// 8 v .. 8 v + 7 into vector v.
struct PixelsOfBlocks {
    alignas(64) std::uint8_t from[64] = {};

    constexpr PixelsOfBlocks() {
        for (int block = 0; block < 4; ++block) {
            for (int j = 0; j < 16; ++j) {
                from[16 * block + j] = static_cast<std::uint8_t>(8 * (j / 2) + 2 * block + j % 2);
            }
        }
    }
};
inline constexpr PixelsOfBlocks pixels_of_blocks;

/// Lanes of `Unit` interleaved within 128-bit blocks: the lower halves, then the upper ones.
template <class Unit, class V>
HWY_INLINE void interleave(V a, V b, V* lower, V* upper) {
    const hn::DFromV<V> bytes;
    const hn::Repartition<Unit, decltype(bytes)> units;
    const auto first = hn::BitCast(units, a);
    const auto second = hn::BitCast(units, b);
    *lower = hn::BitCast(bytes, hn::InterleaveLower(units, first, second));
    *upper = hn::BitCast(bytes, hn::InterleaveUpper(units, first, second));
}

/// The words of 64 pixels from their eight planes.
template <class V>
HWY_INLINE void store_census_words(const V* planes, std::uint8_t* to) {
    const hn::DFromV<V> bytes;
    V plane[8];
    DISPARITYD_UNROLL
    for (int i = 0; i < 8; ++i) {
        plane[i] = permuted(planes[i], pixels_of_blocks.from);
    }
    V two[2][4];  // planes of each: the lower eight pixels of every block, the upper ones
    V four[4][2];
    V eight[8];
    DISPARITYD_UNROLL
    for (int i = 0; i < 4; ++i) {
        interleave<std::uint8_t>(plane[2 * i], plane[2 * i + 1], &two[0][i], &two[1][i]);
    }
    DISPARITYD_UNROLL
    for (int i = 0; i < 4; ++i) {
        const int part = i / 2;
        interleave<std::uint16_t>(two[part][2 * (i % 2)], two[part][2 * (i % 2) + 1], &four[2 * part][i % 2],
                                  &four[2 * part + 1][i % 2]);
    }
    DISPARITYD_UNROLL
    for (int i = 0; i < 4; ++i) {
        interleave<std::uint32_t>(four[i][0], four[i][1], &eight[2 * i], &eight[2 * i + 1]);
    }
    DISPARITYD_UNROLL
    for (int i = 0; i < 8; ++i) {
        hn::StoreU(eight[i], bytes, reinterpret_cast<hn::TFromV<V>*>(to) + 64 * i);
    }
}
#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
