// SPDX-License-Identifier: Apache-2.0
// Step 16 of docs/algorithm.md, its image of a quarter of the size: the pixels of a block lie in one lane of 32 bits.
#if defined(DISPARITYD_CPU_POST_SHRINK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_SHRINK_INL_H_
#undef DISPARITYD_CPU_POST_SHRINK_INL_H_
#else
#define DISPARITYD_CPU_POST_SHRINK_INL_H_
#endif

#include <algorithm>
#include <array>

#include "hwy/highway.h"
#include "kernels/near_plane.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline void shrink(Plane<const std::uint8_t> image, Plane<std::uint8_t> out, Rows rows) {
    const hn::ScalableTag<std::uint8_t> bytes;
    const hn::Repartition<std::uint16_t, decltype(bytes)> pairs;
    const hn::Repartition<std::int32_t, decltype(bytes)> blocks;
    const hn::Rebind<std::uint8_t, decltype(blocks)> results;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(blocks));
    const int whole = image.width / near_block;  // blocks that need no replicated column
    const bool replicates_rows = rows.last * near_block > image.height;
    const int last = replicates_rows ? rows.last - 1 : rows.last;
    if (whole < lanes || whole < out.width) {
        // Of the last column of blocks, the reference sees to all rows.
        const int first = whole < lanes ? 0 : whole;
        reference::shrink(
            {image.data + near_block * first, image.width - near_block * first, image.height, image.stride},
            {out.data + first, out.width - first, out.height, out.stride}, {rows.first, last});
    }
    for (int y = rows.first; y < last && whole >= lanes; ++y) {
        std::array<const std::uint8_t*, near_block> in{};
        for (int i = 0; i < near_block; ++i) {
            in[static_cast<std::size_t>(i)] = image.row(near_block * y + i);
        }
        for (int begin = 0; begin < whole; begin += lanes) {
            const int x = std::min(begin, whole - lanes);  // the last vector overlaps the one before it
            auto sums = hn::Zero(pairs);
            for (const std::uint8_t* row : in) {
                const auto pixels = hn::BitCast(pairs, hn::LoadU(bytes, row + near_block * x));
                sums = hn::Add(sums, hn::Add(hn::And(pixels, hn::Set(pairs, 255)), hn::ShiftRight<8>(pixels)));
            }
            const auto halves = hn::BitCast(blocks, sums);
            const auto sum = hn::Add(hn::And(halves, hn::Set(blocks, 0xffff)), hn::ShiftRight<16>(halves));
            hn::StoreU(hn::DemoteTo(results, hn::ShiftRight<4>(hn::Add(sum, hn::Set(blocks, 8)))), results,
                       out.row(y) + x);
        }
    }
    if (replicates_rows) {
        reference::shrink(image, out, {std::max(last, rows.first), rows.last});
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
