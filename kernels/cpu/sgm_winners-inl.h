// SPDX-License-Identifier: Apache-2.0
// SgmKernels::winner for one layout of candidates and one form of paths: S = down + up + C once for each path, as keys
// of a search for winners.
#if defined(DISPARITYD_CPU_SGM_WINNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_WINNERS_INL_H_
#undef DISPARITYD_CPU_SGM_WINNERS_INL_H_
#else
#define DISPARITYD_CPU_SGM_WINNERS_INL_H_
#endif

#include "kernels/cpu/keyed_winner_row-inl.h"
#include "kernels/cpu/path_form.h"
#include "kernels/cpu/path_offsets-inl.h"
#include "kernels/cpu/winner_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers, PathForm form>
class SgmWinners {
    using Words = hn::Repartition<std::uint16_t, Tag>;
    using W = hn::Vec<Words>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = registers * lanes;
    static constexpr int classes = 2 * registers;
    static constexpr int path_shift = form.diagonals ? 3 : 2;
    static constexpr int paths = 1 << path_shift;
    static constexpr int raised = form.any_p2 ? 0 : raised_cost;
    static constexpr int most_sum = paths * (62 + (form.any_p2 ? 193 : max_byte_p2));
    static_assert(most_sum <= largest_sum);

    // Sums of up to 1000 leave 6 bits to name candidates.
    static constexpr int key_bits = 6;
    static constexpr bool keyed = !form.any_p2 && KeyGroups<Words, classes, key_bits>::possible;
    static_assert(form.any_p2 || most_sum < (no_key >> key_bits));

public:
    static void winner(const SgmGeometry& geometry, const PostOptions& options, const std::uint8_t* down,
                       const std::uint8_t* up, const std::uint8_t* costs, const WinnerRow& out) {
        Minima minima;
        if constexpr (keyed) {
            const auto keys = [=](int x, W* to) { keys_of(x, down, up, costs, to); };
            KeyedWinnerSearch<Words, classes, key_bits, paths * raised>(geometry).run(keys, minima, out.right_winner);
        } else {
            const auto keys = [=](int x, int count, auto take) HWY_ATTR {
                for (int i = 0; i < count; ++i) {
                    W key[classes];
                    named_keys_of(x + i, down, up, costs, key);
                    take(i, key);
                }
            };
            WinnerSearch<Words, classes>(geometry).run(keys, minima, out.right_winner);
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

    // Keys of KeyedWinnerSearch: 64 S of pixel x. C and so S are still raised.
    static HWY_INLINE void keys_of(int x, const std::uint8_t* down, const std::uint8_t* up, const std::uint8_t* costs,
                                   W* out) {
        const Words words;
        const auto high = hn::Set(words, std::uint16_t{0xff00});
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * candidates;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const Pair sum = sums<key_bits>(down + at, up + at, r);
            const auto c = hn::BitCast(words, hn::Load(Tag(), costs + at + r * lanes));
            // 512 C: the odd byte leaves the word by itself.
            out[r] = hn::Add(sum.even, hn::ShiftLeft<key_bits + path_shift>(c));
            out[r + registers] = hn::Add(sum.odd, hn::ShiftLeft<key_bits + path_shift - 8>(hn::And(c, high)));
        }
    }

    // Keys of WinnerSearch, of C no longer raised.
    static HWY_INLINE void named_keys_of(int x, const std::uint8_t* down, const std::uint8_t* up,
                                         const std::uint8_t* costs, W* out) {
        constexpr int cost_shift = name_bits + path_shift;
        const Words words;
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * candidates;
        const auto too_large = hn::Set(Tag(), std::uint8_t{raised});
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const Pair sum = sums<name_bits>(down + at * form.sum_bytes(), up + at * form.sum_bytes(), r);
            const auto c = hn::Sub(hn::Load(Tag(), costs + at + r * lanes), too_large);
            const W even = hn::Add(sum.even, shifted_bytes<false, cost_shift>(words, c));
            const W odd = hn::Add(sum.odd, shifted_bytes<true, cost_shift>(words, c));
            out[r] = key_of_sum<classes>(even, r);
            out[r + registers] = key_of_sum<classes>(odd, registers + r);
        }
    }

    /// 2^shift times what both sweeps left for register r of the pixel that begins there.
    template <int shift>
    static HWY_INLINE Pair sums(const std::uint8_t* down, const std::uint8_t* up, int r) {
        const Words words;
        if constexpr (form.word_sums) {
            const auto of_class = [&](int q) {
                const int at = q * (lanes / 2);
                return hn::ShiftLeft<shift>(hn::Add(hn::Load(words, reinterpret_cast<const std::uint16_t*>(down) + at),
                                                    hn::Load(words, reinterpret_cast<const std::uint16_t*>(up) + at)));
            };
            return {of_class(r), of_class(registers + r)};
        } else {
            const auto a = in_register(hn::Load(Tag(), down + r * lanes));
            const auto b = in_register(hn::Load(Tag(), up + r * lanes));
            return {sum_of_bytes<false, shift>(words, a, b), sum_of_bytes<true, shift>(words, a, b)};
        }
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
