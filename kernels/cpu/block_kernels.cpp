// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/block_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/block_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/cost/census_window-inl.h"
#include "kernels/cpu/cost/sad_rows-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"
#include "kernels/cpu/winner/packed_argmin-inl.h"
#include "kernels/cpu/winner/winner_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers>
struct Block {
    using KeyTag = hn::Repartition<std::uint16_t, Tag>;
    static constexpr int packed_index_bits = 8;  // beside costs of bytes
    static_assert(Census9x7::bits < (no_key >> packed_index_bits));
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int stride = 2 * registers;

    static std::size_t scratch_bytes(const MatchGeometry& geometry) {
        return std::max(SadRows<Tag, registers>::scratch_bytes(geometry),
                        geometry.row_bytes() + SingleRowCosts::bytes(geometry));
    }

    static void sad(const MatchGeometry& geometry, const PostOptions& options, Plane<const std::uint8_t> left,
                    Plane<const std::uint8_t> right, Rows rows, std::uint8_t* scratch, const WinnerPlanes& out) {
        using Windows = SadRows<Tag, registers>;
        Windows windows(geometry, left, right, scratch);
        WinnerSearch<KeyTag, stride, stride <= (many_registers ? 8 : 4)> search(geometry);
        const LeftResults results(geometry, options);
        Minima minima;
        for (int y = rows.first; y < rows.last; ++y) {
            y == rows.first ? windows.begin(y) : windows.move_to(y);
            search.run(typename Windows::WindowSums(windows), minima, out.row(y).right_winner);
            results.row(minima, geometry.width, out.row(y));
        }
    }

    static void census(const MatchGeometry& geometry, const PostOptions& options, MatchingCostKernel matching_cost,
                       CensusPlanes<const std::uint8_t> planes, Rows rows, std::uint8_t* scratch,
                       const WinnerPlanes& out) {
        const KeyTag words;
        const auto keys = [=](int x, hn::Vec<KeyTag>* key) {
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                const std::ptrdiff_t at = (static_cast<std::ptrdiff_t>(x) * registers + r) * lanes;
                const auto costs = hn::BitCast(words, hn::Load(Tag(), scratch + at));
                key[r] = hn::ShiftLeft<packed_index_bits>(costs);  // the odd byte leaves the word by itself
                key[r + registers] = hn::And(costs, hn::Set(words, std::uint16_t{0xff00}));
            }
        };
        PackedArgmin<KeyTag, stride, packed_index_bits, 0> search(geometry);
        const LeftResults results(geometry, options);
        SingleRowCosts single(geometry, scratch + geometry.row_bytes());
        Minima minima;
        for (int y = rows.first; y < rows.last; ++y) {
            const int next = std::min(y + 1, rows.last - 1);
            matching_cost(geometry, planes, y, next, &single, scratch, nullptr);
            search.run(keys, minima, out.row(y).right_winner);
            results.row(minima, geometry.width, out.row(y));
        }
    }

    static BlockKernels table() { return {scratch_bytes, sad, census}; }
};

inline BlockKernels block_kernels_of(int disparities) {
    return with_layout(disparities,
                       [](auto tag, auto registers) { return Block<decltype(tag), registers()>::table(); });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

BlockKernels block_kernels(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, block_kernels_of);
    return built != nullptr ? built(disparities) : BlockKernels{};
}

}  // namespace disparityd::cpu
#endif
