// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/sgm_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

// Highway's emulation of vectors (SCALAR, EMU128), which the compiler's baseline counts as, is slower than the
// reference.
#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/layouts-inl.h"
#include "kernels/cpu/matching_cost-inl.h"
#include "kernels/cpu/path_rows-inl.h"
#include "kernels/cpu/winner_row-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

#if DISPARITYD_CPU_VECTORS

template <class Tag, int registers>
struct Kernels {
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    // Two rows side by side where registers suffice: measured 31 to 20 cycles per pixel with one register of 64 lanes.
    static constexpr int rows_at_once = registers == 1 || (registers == 2 && lanes == 64) ? 2 : 1;

    static void matching_cost(const SgmGeometry& geometry, const std::uint8_t* left, const std::uint8_t* right,
                              std::uint8_t* costs) {
        MatchingCostRow<Tag, registers>(geometry, left, right, costs).run();
    }

    template <int count, bool streaming>
    static void aggregate_rows(const SgmGeometry& geometry, const SweepPass& pass, const PathRow& before,
                               const SweepRow* rows, SweepSteps steps, std::uint8_t* state) {
        PathRows<Tag, registers, count, streaming>(geometry, pass, before).run(rows, pass.direction < 0, steps, state);
    }

    static void aggregate(const SgmGeometry& geometry, const SweepPass& pass, const PathRow& before,
                          const SweepRow* rows, int count, SweepSteps steps, std::uint8_t* state) {
        if (count == rows_at_once) {
            pass.store == Store::stream
                ? aggregate_rows<rows_at_once, true>(geometry, pass, before, rows, steps, state)
                : aggregate_rows<rows_at_once, false>(geometry, pass, before, rows, steps, state);
            return;
        }
        // A row left over: how it is stored does not matter.
        aggregate_rows<1, false>(geometry, pass, before, rows, steps, state);
        if (pass.store == Store::stream && steps.end == steps_of(geometry.width, 1)) {
            std::copy_n(rows->costs, geometry.row_bytes(), rows->costs_copy);
        }
    }

    static void winner(const SgmGeometry& geometry, const PostOptions& options, int direction, const std::uint8_t* down,
                       const std::uint8_t* up, const std::uint8_t* costs, const WinnerRow& out) {
        constexpr int classes = 2 * registers;
        const Tag bytes;
        const hn::Repartition<std::uint16_t, Tag> words;
        const hn::Repartition<std::int16_t, Tag> sum_tag;
        const auto low = hn::Set(words, std::uint16_t{0x00ff});
        const auto eightfold = hn::Set(words, std::uint16_t{0x07f8});
        const auto sums = [=](int x, hn::Vec<decltype(sum_tag)>* out_sums) {
            const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * registers * lanes;
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                const auto a = hn::BitCast(words, hn::Load(bytes, down + at + r * lanes));
                const auto b = hn::BitCast(words, hn::Load(bytes, up + at + r * lanes));
                const auto c = hn::BitCast(words, hn::Load(bytes, costs + at + r * lanes));
                const auto even = hn::Add(hn::And(a, low), hn::And(b, low));
                const auto odd = hn::Add(hn::ShiftRight<8>(a), hn::ShiftRight<8>(b));
                out_sums[r] = hn::BitCast(sum_tag, hn::Add(even, hn::And(hn::ShiftLeft<3>(c), eightfold)));
                out_sums[r + registers] = hn::BitCast(sum_tag, hn::Add(odd, hn::And(hn::ShiftRight<5>(c), eightfold)));
            }
        };
        Minima minima;
        using SumTag = hn::Repartition<std::int16_t, Tag>;
        if (direction > 0) {
            WinnerSearch<SumTag, classes, 1, decltype(sums)>(geometry, sums).run(minima, out.right_winner);
        } else {
            WinnerSearch<SumTag, classes, -1, decltype(sums)>(geometry, sums).run(minima, out.right_winner);
        }
        LeftResults(geometry, options).row(minima, geometry.width, out);
    }

    static SgmKernels table() {
        SgmKernels kernels;
        kernels.layout = {lanes, registers};
        kernels.rows_at_once = rows_at_once;
        kernels.census_layout = census_layout;
        kernels.census_left = census_left;
        kernels.census_right = census_right<registers>;
        kernels.matching_cost = matching_cost;
        kernels.aggregate = aggregate;
        kernels.jumps = adaptive_jumps;
        kernels.winner = winner;
        return kernels;
    }
};

inline SgmKernels kernels_of(int disparities) {
    return with_layout(disparities,
                       [](auto tag, auto registers) { return Kernels<decltype(tag), registers()>::table(); });
}

#else

inline SgmKernels kernels_of(int) {
    return {};
}

#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace disparityd::cpu {

SgmKernels sgm_kernels(std::int64_t target, int disparities) {
    switch (target) {
#if HWY_TARGETS & HWY_AVX3_DL
        case HWY_AVX3_DL: return N_AVX3_DL::kernels_of(disparities);
#endif
#if HWY_TARGETS & HWY_AVX3
        case HWY_AVX3: return N_AVX3::kernels_of(disparities);
#endif
#if HWY_TARGETS & HWY_AVX2
        case HWY_AVX2: return N_AVX2::kernels_of(disparities);
#endif
#if HWY_TARGETS & HWY_SSE4
        case HWY_SSE4: return N_SSE4::kernels_of(disparities);
#endif
#if HWY_TARGETS & HWY_NEON
        case HWY_NEON: return N_NEON::kernels_of(disparities);
#endif
        default: return {};
    }
}

}  // namespace disparityd::cpu
#endif
