// SPDX-License-Identifier: Apache-2.0
// What SgmKernels has in its own way for each form of paths (see path_form.h): aggregation and winners.
#if defined(DISPARITYD_CPU_FORM_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_FORM_KERNELS_INL_H_
#undef DISPARITYD_CPU_FORM_KERNELS_INL_H_
#else
#define DISPARITYD_CPU_FORM_KERNELS_INL_H_
#endif

#include "kernels/cpu/aggregation-inl.h"
#include "kernels/cpu/layouts-inl.h"
#include "kernels/cpu/winner_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers, PathForm form>
struct FormKernels {
    using Words = hn::Repartition<std::uint16_t, Tag>;
    using W = hn::Vec<Words>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int classes = 2 * registers;
    static constexpr int path_shift = form.diagonals ? 3 : 2;

    /// The words of the even and the odd lanes of a register.
    struct Pair {
        HWY_INLINE Pair(W even_lanes, W odd_lanes) : even(even_lanes), odd(odd_lanes) {}
        W even;
        W odd;
    };

    static HWY_INLINE Pair words_at(const std::uint8_t* from) {
        const auto v = hn::Load(Tag(), from);
        return {words_of_bytes<false>(Words(), v), words_of_bytes<true>(Words(), v)};
    }

    /// What a sweep left for register r of the pixel that begins at `pixel`.
    static HWY_INLINE Pair left_sum(const std::uint8_t* pixel, int r) {
        if constexpr (form.word_sums) {
            const auto* words = reinterpret_cast<const std::uint16_t*>(pixel);
            return {hn::Load(Words(), words + r * (lanes / 2)),
                    hn::Load(Words(), words + (registers + r) * (lanes / 2))};
        } else {
            return words_at(pixel + r * lanes);
        }
    }

    /// Keys of pixel x. S is what both sweeps left, and C once for each path.
    static HWY_INLINE void store_keys(int x, const std::uint8_t* down, const std::uint8_t* up,
                                      const std::uint8_t* costs, std::uint16_t* out) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * registers * lanes;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const Pair a = left_sum(down + at * form.sum_bytes(), r);
            const Pair b = left_sum(up + at * form.sum_bytes(), r);
            const Pair c = words_at(costs + at + r * lanes);
            const W even = hn::Add(hn::Add(a.even, b.even), hn::ShiftLeft<path_shift>(c.even));
            const W odd = hn::Add(hn::Add(a.odd, b.odd), hn::ShiftLeft<path_shift>(c.odd));
            hn::Store(key_of_sum<classes>(even, r), Words(), out + r * (lanes / 2));
            hn::Store(key_of_sum<classes>(odd, registers + r), Words(), out + (registers + r) * (lanes / 2));
        }
    }

    static void winner(const SgmGeometry& geometry, const PostOptions& options, const std::uint8_t* down,
                       const std::uint8_t* up, const std::uint8_t* costs, const WinnerRow& out) {
        const auto keys =
            pixel_by_pixel<registers * lanes>([=](int x, std::uint16_t* to) { store_keys(x, down, up, costs, to); });
        Minima minima;
        WinnerSearch<Words, classes>(geometry).run(keys, minima, out.right_winner);
        LeftResults(geometry, options).row(minima, geometry.width, out);
    }
};

/// `kernels`, those of 8 paths in bytes, with what this form has in its own way.
template <PathForm form>
SgmKernels in_form(int disparities, SgmKernels kernels) {
    return with_layout(disparities, [&](auto tag, auto registers) {
        kernels.sum_bytes = form.sum_bytes();
        kernels.raised_cost = 0;
        kernels.aggregate = Aggregation<decltype(tag), registers(), form>::aggregate;
        kernels.winner = FormKernels<decltype(tag), registers(), form>::winner;
        return kernels;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
