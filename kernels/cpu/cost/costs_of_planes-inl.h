// SPDX-License-Identifier: Apache-2.0
// Differing bits of census planes, counted plane by plane for all candidates of a few pixels at once (neighbouring
// pixels share most of what is loaded).
#if defined(DISPARITYD_CPU_COST_COSTS_OF_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_COSTS_OF_PLANES_INL_H_
#undef DISPARITYD_CPU_COST_COSTS_OF_PLANES_INL_H_
#else
#define DISPARITYD_CPU_COST_COSTS_OF_PLANES_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/cost/census_planes-inl.h"
#include "kernels/cpu/cost/cost_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

#if HWY_TARGET != HWY_AVX3_DL && !HWY_ARCH_ARM
struct DifferingBits {
    alignas(16) std::uint8_t of[256] = {};  ///< sixteen for each half byte

    constexpr DifferingBits() {
        for (unsigned a = 0; a < 16; ++a) {
            for (unsigned b = 0; b < 16; ++b) {
                for (unsigned differing = a ^ b; differing != 0; differing &= differing - 1) {
                    ++of[16 * a + b];
                }
            }
        }
    }
};
inline constexpr DifferingBits differing_bits;

/// What counts the bits in which bytes of a plane differ from `left`: the table of one half byte, `left` its place.
template <class Tag>
HWY_INLINE hn::Vec<Tag> counter(Tag tag, std::uint8_t left) {
    return hn::LoadDup128(tag, differing_bits.of + left);
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

/// What the costs of a row that is new are averaged with: rows of the same candidates. `other` is the neighbour of
/// `here` on its other side.
struct Averaged {
    std::uint8_t* keep_new;  ///< the new row's own costs go there
    const std::uint8_t* here;
    const std::uint8_t* other;
};

/// Costs of pixels one after the other; averaged if that is told.
template <class Tag, int registers, class Cost, bool averages>
class CostsOfPlanes {
    using V = hn::Vec<Tag>;
    using Row = CostRow<Tag, registers>;

public:
    /// How many pixels the loops take at once.
    static constexpr int at_once = registers <= (many_registers ? 3 : 2) ? 4 : registers <= 4 ? 2 : 1;
    /// How many pixels that are streamed fill whole lines, if they begin with one.
    static constexpr int pixels_of_lines = at_once;

    /// Costs at least `least`, which stays where it is, or what they are if it is null.
    CostsOfPlanes(const MatchGeometry& geometry, const CensusRow& census, const Row& out,
                  const LeastCosts<Tag, registers>* least, const Averaged& with = {})
        : width_(geometry.width),
          bias_(static_cast<std::uint8_t>(geometry.cost_bias)),
          left_pitch_(geometry.census.left_pitch),
          right_pitch_(geometry.census.right_pitch),
          right_part_(geometry.census.right_part),
          census_(census),
          out_(out),
          least_(least),
          with_(with) {}

    /// Of pixels [x, end); `next` is called for every `at_once` of them that are whole groups.
    template <bool streaming, class Next>
    HWY_INLINE void between(int x, int end, Next next) const {
        OwnMembers own = *this;
        for (; x + at_once <= end; x += at_once) {
            next();
            own.template pixels<at_once, streaming>(x);
        }
        for (; x < end; ++x) {
            own.template pixels<1, streaming>(x);
        }
    }

private:
    // Bytes that are stored could be part of any object whose address is known: what is to stay in registers is copied.
    // Arm has registers for all members, others only for those of pixels().
    using OwnMembers = std::conditional_t<HWY_ARCH_ARM != 0, const CostsOfPlanes, const CostsOfPlanes&>;

    template <int count, bool streaming>
    HWY_INLINE void pixels(int x) const {
        V cost[count][registers];
        count_bits<count>(x, cost);
        const Averaged with = with_;
        const Row out = out_;
        if constexpr (averages) {
            const std::ptrdiff_t at = Row::offset(x, 0);
            DISPARITYD_UNROLL
            for (int i = 0; i < count * registers; ++i) {
                V& c = cost[i / registers][i % registers];
                const std::ptrdiff_t of_register = at + i * static_cast<std::ptrdiff_t>(hn::MaxLanes(Tag()));
                const V other = in_register(hn::Load(tag_, with.other + of_register));
                hn::Store(c, tag_, with.keep_new + of_register);  // perhaps in the place of `other`
                c = hn::AverageRound(hn::AverageRound(other, c), hn::Load(tag_, with.here + of_register));
            }
        }
        if (least_ != nullptr) {
            DISPARITYD_UNROLL
            for (int i = 0; i < count * registers; ++i) {
                V& c = cost[i / registers][i % registers];
                c = hn::Max(c, least_->at(i % registers));
            }
        }
        out.template store<streaming>(*cost, count * registers, x);
    }

    /// Pixels x .. x + count - 1. Candidate registers * lane + r of pixel x + i is entry
    /// (width - 1 - x - i) + registers * lane + r: a load from part (..) % registers.
    template <int count>
    HWY_INLINE void count_bits(int x, V (&cost)[count][registers]) const {
        constexpr int sources = registers + count - 1;
        // Of pixel x + count - 1, register 0; unsigned, as that is divided with fewer instructions.
        const auto entry = static_cast<unsigned>(width_ - x - count);
        std::ptrdiff_t source[sources];
        DISPARITYD_UNROLL
        for (unsigned s = 0; s < sources; ++s) {
            source[s] = part_entry(entry + s);
        }
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            std::fill_n(cost[i], registers, hn::Set(tag_, bias_));
        }
        const std::uint8_t* left = census_.left + x;
        const std::uint8_t* right = census_.right;
        DISPARITYD_UNROLL
        for (int plane = 0; plane < planes_of<Cost>; ++plane) {
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
                // Which plane it is, is known when this is compiled.
                const bool counts = plane < census_planes<Cost>;
                const V left_bits = counts ? counter(tag_, left[i]) : hn::Set(tag_, left[i]);
                DISPARITYD_UNROLL
                for (int r = 0; r < registers; ++r) {
                    const V right_bits = bits[count - 1 - i + r];
                    const V differing = counts ? count_differing(tag_, left_bits, right_bits)
                                               : gradient_cost(tag_, left_bits, right_bits);
                    cost[i][r] = in_register(hn::Add(cost[i][r], differing));
                }
            }
            left += left_pitch_;
            right += right_pitch_;
        }
    }

    std::ptrdiff_t part_entry(unsigned entry) const {
        return static_cast<std::ptrdiff_t>(entry % registers) * right_part_ + entry / registers;
    }

    Tag tag_{};
    int width_;
    std::uint8_t bias_;
    std::ptrdiff_t left_pitch_;
    std::ptrdiff_t right_pitch_;
    std::ptrdiff_t right_part_;
    CensusRow census_;
    Row out_;
    const LeastCosts<Tag, registers>* least_;
    Averaged with_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
