// SPDX-License-Identifier: Apache-2.0
// What the paths of a sweep add at a pixel (see path_pixels-inl.h), and how it lies in memory.
#if defined(DISPARITYD_CPU_SGM_PATH_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_PATH_SUMS_INL_H_
#undef DISPARITYD_CPU_SGM_PATH_SUMS_INL_H_
#else
#define DISPARITYD_CPU_SGM_PATH_SUMS_INL_H_
#endif

#include "hwy/cache_control.h"
#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The sum of M over the paths of one pixel, r counting its registers.
template <class Tag, int registers, bool words>
class PathSums;

/// In bytes, as candidates lie.
template <class Tag, int registers>
class PathSums<Tag, registers, false> {
    using V = hn::Vec<Tag>;

public:
    PathSums() {}

    HWY_INLINE void set(int r, V m) { sum_[r] = m; }
    HWY_INLINE void add(int r, V m) { sum_[r] = hn::Add(sum_[r], m); }

    template <bool streaming>
    HWY_INLINE void store(std::uint8_t* to) const {
        const Tag tag;
        constexpr auto bytes = static_cast<std::ptrdiff_t>(hn::MaxLanes(Tag()));
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            if constexpr (streaming) {
                hn::Stream(sum_[r], tag, to + r * bytes);
            } else {
                hn::Store(sum_[r], tag, to + r * bytes);
            }
        }
    }

private:
    V sum_[registers];
};

/// In words: those of the even lanes of all registers, then those of the odd ones; candidates lie in them by
/// residue, see match_layout.h.
template <class Tag, int registers>
class PathSums<Tag, registers, true> {
    using V = hn::Vec<Tag>;
    using Words = hn::Repartition<std::uint16_t, Tag>;
    using W = hn::Vec<Words>;

public:
    PathSums() {}

    HWY_INLINE void set(int r, V m) {
        even_[r] = words_of_bytes<false>(Words(), m);
        odd_[r] = words_of_bytes<true>(Words(), m);
    }
    HWY_INLINE void add(int r, V m) {
        even_[r] = hn::Add(even_[r], words_of_bytes<false>(Words(), m));
        odd_[r] = hn::Add(odd_[r], words_of_bytes<true>(Words(), m));
    }

    template <bool streaming>
    HWY_INLINE void store(std::uint8_t* to) const {
        constexpr auto bytes = static_cast<std::ptrdiff_t>(hn::MaxLanes(Tag()));
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            store<streaming>(even_[r], to + r * bytes);
            store<streaming>(odd_[r], to + (registers + r) * bytes);
        }
    }

private:
    template <bool streaming>
    static HWY_INLINE void store(W sum, std::uint8_t* to) {
        const Words words;
        auto* at = reinterpret_cast<std::uint16_t*>(to);
        if constexpr (streaming) {
            hn::Stream(sum, words, at);
        } else {
            hn::Store(sum, words, at);
        }
    }

    W even_[registers];
    W odd_[registers];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
