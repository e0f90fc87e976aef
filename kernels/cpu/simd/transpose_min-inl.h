// SPDX-License-Identifier: Apache-2.0
// Minima over all lanes for many pixels at once, by a transpose: a tree of interleaving and Min. It takes a few
// operations per pixel instead of a dependent chain of shuffles for each.
#if defined(DISPARITYD_CPU_SIMD_TRANSPOSE_MIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_TRANSPOSE_MIN_INL_H_
#undef DISPARITYD_CPU_SIMD_TRANSPOSE_MIN_INL_H_
#else
#define DISPARITYD_CPU_SIMD_TRANSPOSE_MIN_INL_H_
#endif

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Two vectors interleaved and taken by twos: half as many values of each pixel.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V min_interleaved(Tag tag, V even, V odd) {
    return hn::Min(hn::InterleaveLower(tag, even, odd), hn::InterleaveUpper(tag, even, odd));
}

/// `load(i)` gives a vector of pixel i. Pixels first, first + step, .. (as many as a 128-bit block has lanes): lane j
/// of every block of the result is the least value that pixel j has in this block.
template <int step, class Tag, class Load>
HWY_INLINE hn::Vec<Tag> min_by_block(Tag tag, int first, Load load) {
    constexpr int lanes_of_block = 16 / static_cast<int>(sizeof(hn::TFromD<Tag>));
    if constexpr (step == lanes_of_block) {
        return load(first);
    } else {
        return min_interleaved(tag, min_by_block<2 * step>(tag, first, load),
                               min_by_block<2 * step>(tag, first + step, load));
    }
}

/// The least lane of each of 16 (bytes) or 8 (words) pixels, one 128-bit vector in the order of the pixels.
template <class Tag, class Load>
HWY_INLINE auto transpose_min(Tag tag, Load load) {
    return min_of_blocks(tag, min_by_block<1>(tag, 0, load));
}

/// Of the words of eight pixels that come one after the other the last of every 128-bit block, side by side.
template <class Tag>
class LastLanesOfEight {
    using V = hn::Vec<Tag>;

public:
    LastLanesOfEight() {}  // written out: GCC compiles an implicit one for the baseline

    /// Of pixel k, which the compiler has to know.
    HWY_INLINE void add(int k, V v) {
        waiting_[k % 2] = v;
        if (k % 2 == 1) {
            twos_[k / 2 % 2] = upper(Tag(), waiting_[0], waiting_[1]);
        }
        if (k % 4 == 3) {
            fours_[k / 4] = upper(hn::Repartition<std::uint32_t, Tag>(), twos_[0], twos_[1]);
        }
    }

    /// After pixel 7.
    HWY_INLINE V last_lanes() const { return upper(hn::Repartition<std::uint64_t, Tag>(), fours_[0], fours_[1]); }

private:
    template <class Wide>
    static HWY_INLINE V upper(Wide wide, V first, V second) {
        return hn::BitCast(Tag(), hn::InterleaveUpper(wide, hn::BitCast(wide, first), hn::BitCast(wide, second)));
    }

    V waiting_[2];
    V twos_[2];
    V fours_[2];
};

/// The same of `load(k)` for pixel k.
template <class Tag, class Load>
HWY_INLINE hn::Vec<Tag> last_lanes_side_by_side(Tag, Load load) {
    LastLanesOfEight<Tag> eight;
    DISPARITYD_UNROLL
    for (int k = 0; k < 8; ++k) {
        eight.add(k, load(k));
    }
    return eight.last_lanes();
}

/// Vectors of words of eight pixels that come one after the other, until all are there.
template <class Tag>
class EightInMemory {
    using V = hn::Vec<Tag>;

public:
    HWY_INLINE void add(int k, V v) { hn::Store(v, Tag(), words_ + k * lanes); }
    HWY_INLINE V minima() const { return min_by_block<1>(Tag(), 0, loads()); }
    HWY_INLINE V last_lanes() const { return last_lanes_side_by_side(Tag(), loads()); }

private:
    static constexpr auto lanes = static_cast<std::ptrdiff_t>(hn::MaxLanes(Tag()));

    HWY_INLINE auto loads() const {
        return [this](int k) HWY_ATTR { return hn::Load(Tag(), words_ + k * lanes); };
    }
    alignas(64) std::uint16_t words_[8 * lanes];
};

/// What EightInMemory::minima() gives, where there are many registers: of the eight no more than four wait there.
template <class Tag>
class Min8 {
    using V = hn::Vec<Tag>;

public:
    Min8() {}  // written out as above

    /// Of pixel k, which the compiler has to know.
    HWY_INLINE void add(int k, V v) {
        if (k < 4) {
            waiting_[k] = v;
            return;
        }
        combine(k - 4, v);
        if (k >= 6) {
            combine(k - 6, waiting_[k - 4]);
        }
        if (k == 7) {
            combine(0, waiting_[1]);
        }
    }

    /// min_by_block<1>() of all, after pixel 7.
    HWY_INLINE V minima() const { return waiting_[0]; }

private:
    HWY_INLINE void combine(int i, V odd) { waiting_[i] = min_interleaved(Tag(), waiting_[i], odd); }

    V waiting_[4];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
