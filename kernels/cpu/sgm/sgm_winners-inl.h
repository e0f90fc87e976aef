// SPDX-License-Identifier: Apache-2.0
// SgmKernels::winner for one layout of candidates and one variant of paths: S = down + up + C once for each path, as
// keys of a search for winners.
#if defined(DISPARITYD_CPU_SGM_SGM_WINNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_SGM_WINNERS_INL_H_
#undef DISPARITYD_CPU_SGM_SGM_WINNERS_INL_H_
#else
#define DISPARITYD_CPU_SGM_SGM_WINNERS_INL_H_
#endif

#include <type_traits>

#include "kernels/cpu/sgm/path_offsets-inl.h"
#include "kernels/cpu/sgm/path_variant.h"
#include "kernels/cpu/simd/prefetch-inl.h"
#include "kernels/cpu/winner/packed_argmin-inl.h"
#include "kernels/cpu/winner/winner_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers, PathVariant variant>
class SgmWinners {
    using Words = hn::Repartition<std::uint16_t, Tag>;
    using W = hn::Vec<Words>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = registers * lanes;
    static constexpr int stride = 2 * registers;
    static constexpr int path_shift = variant.diagonals ? 3 : 2;
    static constexpr int paths = 1 << path_shift;
    static constexpr int bias = variant.any_p2 ? 0 : cost_bias;
    static constexpr int max_sum = paths * (62 + (variant.any_p2 ? 193 : max_byte_p2));
    static_assert(max_sum <= largest_sum);

    // Where a register is half of what the processor has, its words fill a whole one.
    static constexpr bool wide =
        HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3 && lanes == 32 && registers > 1 && !variant.any_p2;
    using KeyWords = std::conditional_t<wide, hn::Rebind<std::uint16_t, Tag>, Words>;
    static constexpr int key_stride = wide ? registers : stride;

    // Sums of up to 1000 leave 6 bits for the index of a candidate.
    static constexpr int packed_index_bits = 6;
    static constexpr bool packed = !variant.any_p2 && PackedGroups<KeyWords, key_stride, packed_index_bits>::possible;
    static_assert(packed || !wide);
    static_assert(variant.any_p2 || max_sum < (no_key >> packed_index_bits));

public:
    static void winner(const MatchGeometry& geometry, const PostOptions& options, const SumRows& sums,
                       const std::uint8_t* costs, const WinnerRow& out) {
        Minima minima;
        if constexpr (packed) {
            const auto keys = [=](int x, hn::Vec<KeyWords>* to) {
                ask_for_costs(sums, x);
                if constexpr (wide) {
                    wide_keys_of(x, sums, costs, to);
                } else {
                    keys_of(x, sums, costs, to);
                }
            };
            PackedArgmin<KeyWords, key_stride, packed_index_bits, paths * bias>(geometry).run(keys, minima,
                                                                                              out.right_winner);
        } else {
            const auto keys = [=](int x, int count, auto take) HWY_ATTR {
                for (int i = 0; i < count; ++i) {
                    W key[stride];
                    ask_for_costs(sums, x + i);
                    indexed_keys_of(x + i, sums, costs, key);
                    take(i, key);
                }
            };
            WinnerSearch<Words, stride>(geometry).run(keys, minima, out.right_winner);
        }
        LeftResults(geometry, options).row(minima, geometry.width, out);
    }

private:
    /// The words of the even and the odd lanes of a register.
    struct Pair {
        HWY_INLINE Pair(W even_lanes, W odd_lanes) : even(even_lanes), odd(odd_lanes) {}
        W even;
        W odd;
    };

    static HWY_INLINE void ask_for_costs(const SumRows& sums, int x) {
        if constexpr (variant.may_add()) {
            const std::uint8_t* next = sums.next_costs + static_cast<std::ptrdiff_t>(x) * candidates;
            DISPARITYD_UNROLL
            for (int i = 0; i < candidates; i += static_cast<int>(cache_line)) {
                prefetch_to_second_level(next + i);
            }
        }
    }

    // Keys of PackedArgmin: 64 S of pixel x. C and so S still have their bias.
    static HWY_INLINE void keys_of(int x, const SumRows& sums, const std::uint8_t* costs, W* out) {
        const Words words;
        const auto high = hn::Set(words, std::uint16_t{0xff00});
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * candidates;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const Pair sum = shifted_sums<packed_index_bits>(sums, at, r);
            const auto c = hn::BitCast(words, hn::Load(Tag(), costs + at + r * lanes));
            // 512 C: the odd byte leaves the word by itself.
            out[r] = hn::Add(sum.even, hn::ShiftLeft<packed_index_bits + path_shift>(c));
            out[r + registers] = hn::Add(sum.odd, hn::ShiftLeft<packed_index_bits + path_shift - 8>(hn::And(c, high)));
        }
    }

    // The same where keys are `wide`: the words of a register in their order.
    static HWY_INLINE void wide_keys_of(int x, const SumRows& sums, const std::uint8_t* costs, hn::Vec<KeyWords>* out) {
        const KeyWords words;
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * candidates;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const auto words_at = [=](const std::uint8_t* from)
                                      HWY_ATTR { return hn::PromoteTo(words, hn::Load(Tag(), from + at + r * lanes)); };
            auto sum = words_at(sums.sums);
            if constexpr (!variant.may_add()) {
                sum = hn::Add(sum, words_at(sums.others));
            }
            out[r] = hn::ShiftLeft<packed_index_bits>(hn::Add(sum, hn::ShiftLeft<path_shift>(words_at(costs))));
        }
    }

    // Keys of WinnerSearch, of C without its bias.
    static HWY_INLINE void indexed_keys_of(int x, const SumRows& sums, const std::uint8_t* costs, W* out) {
        constexpr int cost_shift = index_bits + path_shift;
        const Words words;
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * candidates;
        const auto all_bias = hn::Set(Tag(), std::uint8_t{bias});
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const Pair sum = shifted_sums<index_bits>(sums, at * variant.sum_bytes(), r);
            const auto c = hn::Sub(hn::Load(Tag(), costs + at + r * lanes), all_bias);
            const W even = hn::Add(sum.even, shifted_bytes<false, cost_shift>(words, c));
            const W odd = hn::Add(sum.odd, shifted_bytes<true, cost_shift>(words, c));
            out[r] = key_of_sum<stride>(even, r);
            out[r + registers] = key_of_sum<stride>(odd, registers + r);
        }
    }

    /// 2^shift times what both sweeps left for register r of the pixel that begins at byte `at`.
    template <int shift>
    static HWY_INLINE Pair shifted_sums(const SumRows& sums, std::ptrdiff_t at, int r) {
        const Words words;
        if constexpr (variant.u16_sums) {
            const auto words_of = [&](const std::uint8_t* row, int q) HWY_ATTR {
                return hn::Load(words, reinterpret_cast<const std::uint16_t*>(row + at) + q * (lanes / 2));
            };
            const auto of_residue = [&](int q) HWY_ATTR {
                return hn::ShiftLeft<shift>(hn::Add(words_of(sums.sums, q), words_of(sums.others, q)));
            };
            return {of_residue(r), of_residue(registers + r)};
        } else {
            const auto a = in_register(hn::Load(Tag(), sums.sums + at + r * lanes));
            if constexpr (variant.may_add()) {
                return {shifted_bytes<false, shift>(words, a), shifted_bytes<true, shift>(words, a)};
            } else {
                const auto b = in_register(hn::Load(Tag(), sums.others + at + r * lanes));
                return {sum_of_bytes<false, shift>(words, a, b), sum_of_bytes<true, shift>(words, a, b)};
            }
        }
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
