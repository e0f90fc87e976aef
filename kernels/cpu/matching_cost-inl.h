// SPDX-License-Identifier: Apache-2.0
// Step 4 of docs/algorithm.md, one row: differing bits of the census planes, counted plane by plane for all candidates
// of a few pixels at once (neighbouring pixels share most of what is loaded).
#if defined(DISPARITYD_CPU_MATCHING_COST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_MATCHING_COST_INL_H_
#undef DISPARITYD_CPU_MATCHING_COST_INL_H_
#else
#define DISPARITYD_CPU_MATCHING_COST_INL_H_
#endif

#include "kernels/cpu/census_planes-inl.h"
#include "kernels/cpu/prefetch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr std::uint8_t outside_cost = census_bits;

#if HWY_TARGET != HWY_AVX3_DL && !HWY_ARCH_ARM
struct DifferingBits {
    alignas(16) std::uint8_t of[16][16] = {};

    constexpr DifferingBits() {
        for (unsigned a = 0; a < 16; ++a) {
            for (unsigned b = 0; b < 16; ++b) {
                for (unsigned differing = a ^ b; differing != 0; differing &= differing - 1) {
                    ++of[a][b];
                }
            }
        }
    }
};
inline constexpr DifferingBits differing_bits;

/// What counts the bits in which bytes of a plane differ from `left`: the table of one half byte, `left` its place.
template <class Tag>
HWY_INLINE hn::Vec<Tag> counter(Tag tag, std::uint8_t left) {
    return hn::LoadDup128(tag, differing_bits.of[0] + left);
}
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V count_differing(Tag, V counter, V right) {
    return hn::TableLookupBytes(counter, right);
}
#else
template <class Tag>
HWY_INLINE hn::Vec<Tag> counter(Tag tag, std::uint8_t left) {
    return hn::Set(tag, left);
}
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE V count_differing(Tag, V counter, V right) {
    return hn::PopulationCount(hn::Xor(counter, right));
}
#endif

template <class Tag, int registers>
class MatchingCostRow {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = registers * lanes;

public:
    MatchingCostRow(const SgmGeometry& geometry, const CensusRow& census, const CensusRow& next, std::uint8_t* costs,
                    std::uint8_t* streamed = nullptr)
        : geometry_(geometry),
          left_(census.left),
          right_(census.right),
          next_(next),
          costs_(costs),
          streamed_(streamed),
          padded_(geometry.range.count != candidates),
          raised_(static_cast<std::uint8_t>(geometry.raised_cost)) {}

    /// Not in line: within the loops around it, its own find too few registers.
    HWY_NOINLINE void run() const {
        const int width = geometry_.width;
        const DisparityRange range = geometry_.range;
        // From `first` to `end` all candidates are inside the right image.
        const int first = std::clamp(range.first + range.count - 1, 0, width);
        const int end = std::clamp(width + range.first, first, width);
        NextPlanes next(next_, geometry_.census, std::max(width / at_once, 1));
        if (streamed_ != nullptr && !padded_) {
            const int first_streamed = std::min((first + at_once - 1) / at_once * at_once, end);
            pixels_between<false>(0, first_streamed, next);
            pixels_between<true>(first_streamed, end, next);
            pixels_between<false>(end, width, next);
            set_outside<true>(0, first_streamed);
            set_outside<true>(end, width);
            return;
        }
        pixels_between<false>(0, width, next);
        set_outside<false>(0, first);
        set_outside<false>(end, width);
        if (padded_) {
            set_padding();
        }
        if (streamed_ != nullptr) {
            std::copy_n(costs_, geometry_.row_bytes(), streamed_);
        }
    }

private:
    static constexpr int at_once = registers <= 2 ? 4 : registers <= 4 ? 2 : 1;

    /// The planes of the next row, asked for little by little.
    struct NextPlanes {
        NextPlanes(const CensusRow& row, const CensusLayout& layout, int portions)
            : left({row.left, layout.left_row()}, portions), right({row.right, layout.right_row()}, portions) {}

        Prefetch left;
        Prefetch right;
    };

    template <bool streaming>
    HWY_INLINE void pixels_between(int x, int end, NextPlanes& next) const {
        for (; x + at_once <= end; x += at_once) {
            next.left.portion();
            next.right.portion();
            pixels<at_once, streaming>(x);
        }
        for (; x < end; ++x) {
            pixels<1, streaming>(x);
        }
    }

    /// Pixels x .. x + count - 1. Candidate registers * lane + r of pixel x + i is entry
    /// (width - 1 - x - i) + registers * lane + r: a load from part (..) % registers.
    template <int count, bool streaming>
    HWY_INLINE void pixels(int x) const {
        constexpr int sources = registers + count - 1;
        // Of pixel x + count - 1, register 0; unsigned, as that is divided with fewer instructions.
        const auto entry = static_cast<unsigned>(geometry_.width - x - count);
        std::ptrdiff_t source[sources];
        DISPARITYD_UNROLL
        for (unsigned s = 0; s < sources; ++s) {
            source[s] = part_entry(entry + s);
        }
        V cost[count][registers];
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            std::fill_n(cost[i], registers, hn::Set(tag_, raised(0)));
        }
        const std::uint8_t* left = left_ + x;
        const std::uint8_t* right = right_;
        DISPARITYD_UNROLL
        for (int plane = 0; plane < census_planes; ++plane) {
            V bits[sources];
            if constexpr (registers == 1 && count == 4) {
                // Four loads across cache lines would take longer than all that is done with them.
                bits[0] = in_register(hn::LoadU(tag_, right + source[0]));
                const V next = in_register(hn::LoadU(tag_, right + source[0] + bytes_to_next));
                bits[1] = bytes_between<1>(bits[0], next);
                bits[2] = bytes_between<2>(bits[0], next);
                bits[3] = bytes_between<3>(bits[0], next);
            } else {
                DISPARITYD_UNROLL
                for (int s = 0; s < sources; ++s) {
                    bits[s] = in_register(hn::LoadU(tag_, right + source[s]));
                }
            }
            DISPARITYD_UNROLL
            for (int i = 0; i < count; ++i) {
                const V left_bits = counter(tag_, left[i]);
                DISPARITYD_UNROLL
                for (int r = 0; r < registers; ++r) {
                    const V differing = count_differing(tag_, left_bits, bits[count - 1 - i + r]);
                    cost[i][r] = in_register(hn::Add(cost[i][r], differing));
                }
            }
            left += geometry_.census.left_pitch;
            right += geometry_.census.right_pitch;
        }
        store<streaming>(*cost, count * registers, x);
    }

    std::ptrdiff_t part_entry(unsigned entry) const {
        return static_cast<std::ptrdiff_t>(entry % registers) * geometry_.census.right_part + entry / registers;
    }

    std::uint8_t raised(int cost) const { return static_cast<std::uint8_t>(raised_ + cost); }
    std::uint8_t outside() const { return raised(outside_cost); }

    std::uint8_t* pixel(int x) const { return costs_ + static_cast<std::ptrdiff_t>(x) * candidates; }

    /// `count` registers from pixel x on.
    template <bool streaming>
    HWY_INLINE void store(const V* costs, int count, int x) const {
        std::uint8_t* const out = pixel(x);
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            hn::Store(costs[i], tag_, out + i * lanes);
        }
        if constexpr (streaming) {  // without other stores between the parts of a line
            std::uint8_t* const past_caches = streamed_ + (out - costs_);
            DISPARITYD_UNROLL
            for (int i = 0; i < count; ++i) {
                hn::Stream(costs[i], tag_, past_caches + i * lanes);
            }
        }
    }

    /// Which candidate each lane of register r holds.
    V candidate(int r) const {
        alignas(64) std::uint8_t k[lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            k[lane] = static_cast<std::uint8_t>(registers * lane + r);
        }
        return hn::Load(tag_, k);
    }

    /// Candidates outside the right image, of pixels [x, end).
    template <bool streaming>
    void set_outside(int x, int end) const {
        const int width = geometry_.width;
        const DisparityRange range = geometry_.range;
        V k[registers];
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            k[r] = candidate(r);
        }
        for (; x < end; ++x) {
            const int first = std::clamp(x - (width - 1) - range.first, 0, range.count);
            const int last = std::clamp(x + 1 - range.first, first, range.count);
            V cost[registers];
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                cost[r] = hn::Load(tag_, pixel(x) + r * lanes);
                cost[r] = first == last ? hn::Set(tag_, outside()) : keep(cost[r], k[r], first, last);
            }
            store<streaming>(cost, registers, x);
        }
    }

    /// The cost where candidate k is one of first .. last - 1.
    V keep(V cost, V k, int first, int last) const {
        const V from_first = hn::Sub(k, hn::Set(tag_, static_cast<std::uint8_t>(first)));
        const V limit = hn::Set(tag_, static_cast<std::uint8_t>(last - 1 - first));
        return hn::IfThenElse(hn::Eq(hn::Max(from_first, limit), limit), cost, hn::Set(tag_, outside()));
    }

    /// Lanes past the last candidate.
    void set_padding() const {
        const V last = hn::Set(tag_, static_cast<std::uint8_t>(geometry_.range.count - 1));
        V least[registers];
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const V k = candidate(r);
            const auto inside = hn::Eq(hn::Max(k, last), last);
            least[r] = hn::IfThenElse(inside, hn::Zero(tag_), hn::Set(tag_, raised(padding_cost)));
        }
        for (int x = 0; x < geometry_.width; ++x) {
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                std::uint8_t* at = pixel(x) + r * lanes;
                hn::Store(hn::Max(least[r], hn::Load(tag_, at)), tag_, at);
            }
        }
    }

    const Tag tag_{};
    const SgmGeometry& geometry_;
    const std::uint8_t* left_;
    const std::uint8_t* right_;
    CensusRow next_;
    std::uint8_t* costs_;
    std::uint8_t* streamed_;
    bool padded_;
    std::uint8_t raised_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
