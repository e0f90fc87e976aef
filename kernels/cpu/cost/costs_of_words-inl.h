// SPDX-License-Identifier: Apache-2.0
// Differing bits of census words, counted word by word. A vector of words holds an eighth of a register's candidates;
// eight of them are packed into one of bytes. Pixels that lie as many candidates apart as a vector holds share all
// words but those of one vector, so several of them are worked on at once.
#if defined(DISPARITYD_CPU_COST_COSTS_OF_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_COSTS_OF_WORDS_INL_H_
#undef DISPARITYD_CPU_COST_COSTS_OF_WORDS_INL_H_
#else
#define DISPARITYD_CPU_COST_COSTS_OF_WORDS_INL_H_
#endif

#include "kernels/cpu/cost/cost_row-inl.h"
#include "kernels/cpu/match_layout.h"
#include "kernels/cpu/simd/prefetch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Where a plane holds words.
template <class Tag>
class CostsOfWords;

#if HWY_TARGET == HWY_AVX3_DL
/// The low halves of small words, what Highway has for larger numbers only: block by block those of `a`, then of `b`.
template <class V>
HWY_INLINE V pack_16_to_8(V a, V b) {
    if constexpr (sizeof(a.raw) == 64) {
        return V{_mm512_packus_epi16(a.raw, b.raw)};
    } else if constexpr (sizeof(a.raw) == 32) {
        return V{_mm256_packus_epi16(a.raw, b.raw)};
    } else {
        return V{_mm_packus_epi16(a.raw, b.raw)};
    }
}

/// Where byte i of eight vectors of words, one after the other, is after packing: two words of each of the eight are in
/// each block.
template <int lanes>
struct PackedPlaces {
    alignas(64) std::uint8_t from[lanes] = {};

    constexpr PackedPlaces() {
        constexpr int words = lanes / 8;
        for (int i = 0; i < lanes; ++i) {
            const int vector = i / words;
            const int word = i % words;
            from[i] = static_cast<std::uint8_t>(16 * (word / 2) + 2 * vector + word % 2);
        }
    }
};
template <int lanes>
inline constexpr PackedPlaces<lanes> packed_places;

template <class V>
HWY_INLINE V in_order(V packed) {
    if constexpr (sizeof(packed.raw) == 16) {
        return packed;
    } else {
        return permuted(packed, packed_places<sizeof(packed.raw)>.from);
    }
}

template <class Tag>
class CostsOfWords {
    using V = hn::Vec<Tag>;
    using Words = hn::Repartition<std::uint64_t, Tag>;
    using W = hn::Vec<Words>;
    static constexpr int words = static_cast<int>(hn::MaxLanes(Words()));  // of a vector: so far apart lie such pixels
    static constexpr int vectors = 8;

public:
    /// How many pixels the loops take at once: measured, with more nothing is gained.
    static constexpr int at_once = 6;
    /// How many pixels that are streamed fill whole lines; 0: they come in another order.
    static constexpr int pixels_of_lines = sizeof(V) == cache_line ? 1 : 0;

    /// Costs at least `least`, or what they are if it is null.
    CostsOfWords(const MatchGeometry& geometry, const CensusRow& census, const CostRow<Tag, 1>& out,
                 const LeastCosts<Tag, 1>* least)
        : left_(reinterpret_cast<const std::uint64_t*>(census.left)),
          right_(reinterpret_cast<const std::uint64_t*>(census.right)),
          width_(geometry.width),
          bias_(hn::Set(Tag(), static_cast<std::uint8_t>(geometry.cost_bias))),
          least_(least == nullptr ? hn::Zero(Tag()) : least->at(0)),
          out_(out) {}

    /// Of pixels [x, end); `next` is called for every `at_once` of them that are whole groups.
    template <bool streaming, class Next>
    HWY_INLINE void between(int x, int end, Next next) const {
        for (; x + at_once * words <= end; x += at_once * words) {
            for (int i = 0; i < words; ++i) {
                next();
                pixels<at_once, streaming>(x + i);
            }
        }
        for (; x < end; ++x) {
            pixels<1, streaming>(x);
        }
    }

private:
    /// Pixels x, x + words, .. Candidate k of pixel x is entry width - 1 - x + k.
    template <int count, bool streaming>
    HWY_INLINE void pixels(int x) const {
        const int last = x + (count - 1) * words;
        const std::uint64_t* right = right_ + (width_ - 1 - last);
        W of_right[vectors + count - 1];
        DISPARITYD_UNROLL
        for (int i = 0; i < vectors + count - 1; ++i) {
            of_right[i] = in_register(hn::LoadU(Words(), right + i * words));
        }
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            const int pixel = last - i * words;
            const V packed = differing(of_right + i, hn::Set(Words(), left_[pixel]));
            const V cost = hn::Max(hn::Add(in_order(packed), bias_), least_);
            out_.template store<streaming>(&cost, 1, pixel);
        }
    }

    static HWY_INLINE V differing(const W* right, W left) {
        const auto bits = [&](int i) HWY_ATTR { return hn::PopulationCount(hn::Xor(right[i], left)); };
        const auto two = [&](int i) HWY_ATTR { return pack_32_to_16(bits(i), bits(i + 1)); };
        const auto four = [&](int i) HWY_ATTR { return pack_32_to_16(two(i), two(i + 2)); };
        return hn::BitCast(Tag(), pack_16_to_8(four(0), four(4)));
    }

    template <class Counts>
    static HWY_INLINE auto pack_32_to_16(Counts a, Counts b) {
        const hn::Repartition<std::int32_t, Tag> from;
        const hn::Repartition<std::int16_t, Tag> to;
        return hn::ReorderDemote2To(to, hn::BitCast(from, a), hn::BitCast(from, b));
    }

    const std::uint64_t* left_;
    const std::uint64_t* right_;
    int width_;
    V bias_;
    V least_;
    CostRow<Tag, 1> out_;
};
#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
