// SPDX-License-Identifier: Apache-2.0
// Minima over all lanes for many pixels at once: a tree of interleaving and Min, a few operations per pixel instead of
// a dependent chain of shuffles for each.
#if defined(DISPARITYD_CPU_LEAST_OF_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_LEAST_OF_PIXELS_INL_H_
#undef DISPARITYD_CPU_LEAST_OF_PIXELS_INL_H_
#else
#define DISPARITYD_CPU_LEAST_OF_PIXELS_INL_H_
#endif

#include "kernels/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// `load(i)` gives a vector of pixel i. Pixels first, first + step, .. (as many as a 128-bit block has lanes): lane j
/// of every block of the result is the least value that pixel j has in this block.
template <int step, class Tag, class Load>
HWY_INLINE hn::Vec<Tag> least_by_block(Tag tag, int first, Load load) {
    constexpr int lanes_of_block = 16 / static_cast<int>(sizeof(hn::TFromD<Tag>));
    if constexpr (step == lanes_of_block) {
        return load(first);
    } else {
        const auto even = least_by_block<2 * step>(tag, first, load);
        const auto odd = least_by_block<2 * step>(tag, first + step, load);
        return hn::Min(hn::InterleaveLower(tag, even, odd), hn::InterleaveUpper(tag, even, odd));
    }
}

/// The least lane of each of 16 (bytes) or 8 (words) pixels, one 128-bit vector in the order of the pixels.
template <class Tag, class Load>
HWY_INLINE auto least_of_pixels(Tag tag, Load load) {
    return least_of_blocks(tag, least_by_block<1>(tag, 0, load));
}

/// Of the words of eight pixels the last of every 128-bit block, in the order of the pixels.
template <class Tag, class Load>
HWY_INLINE hn::Vec<Tag> last_lanes_side_by_side(Tag tag, Load load) {
    const auto pair = [](auto wide, auto first, auto second) {
        return hn::InterleaveUpper(wide, hn::BitCast(wide, first), hn::BitCast(wide, second));
    };
    const auto four = [&](int i) {
        const hn::Repartition<std::uint32_t, Tag> twos;
        return pair(twos, pair(tag, load(i), load(i + 1)), pair(tag, load(i + 2), load(i + 3)));
    };
    return hn::BitCast(tag, pair(hn::Repartition<std::uint64_t, Tag>(), four(0), four(4)));
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
