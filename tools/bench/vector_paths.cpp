// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vector_paths.h"

#include <algorithm>

#include "kernels/steps.h"

#define HWY_TARGET_INCLUDE "tools/bench/vector_paths.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#define DISPARITYD_BENCH_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_BENCH_VECTORS
#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int margin = 64;  // a whole vector on either side

template <class Tag, class V = hn::Vec<Tag>>
std::uint8_t min_by_tree(Tag tag, V v) {
    const hn::FixedTag<std::uint8_t, 16> block_tag;
    auto block = cpu::HWY_NAMESPACE::min_of_blocks(tag, v);
    block = hn::Min(block, hn::ShiftRightBytes<8>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<4>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<2>(block_tag, block));
    block = hn::Min(block, hn::ShiftRightBytes<1>(block_tag, block));
    return hn::GetLane(block);
}

template <class Tag, class V = hn::Vec<Tag>>
std::uint8_t min_lane_by_lane(Tag tag, V v) {
    alignas(64) std::uint8_t lanes[hn::MaxLanes(Tag())];
    hn::Store(v, tag, lanes);
    unsigned least = 255;
    for (const unsigned lane : lanes) {
        least = lane < least ? lane : least;
        // Nobody knows what is in the register: the compiler would make a tree of this loop.
        asm volatile("" : "+r"(least));
    }
    return static_cast<std::uint8_t>(least);
}

template <bool tree, class Tag>
std::uint8_t continue_with(Tag tag, const std::uint8_t* cost, int disparities, int p1, int p2,
                           const std::uint8_t* before, std::uint8_t min_before, std::uint8_t* path) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    alignas(64) std::uint8_t capped[max_disparities + 2 * margin];
    std::uint8_t* middle = capped + margin;
    const auto jump = hn::Set(tag, static_cast<std::uint8_t>(p2));
    const auto penalty = hn::Set(tag, static_cast<std::uint8_t>(p1));
    const auto least = hn::Set(tag, min_before);
    for (int k = 0; k < disparities; k += lanes) {
        hn::Store(hn::Min(hn::Sub(hn::LoadU(tag, before + k), least), jump), tag, middle + k);
    }
    middle[-1] = static_cast<std::uint8_t>(p2);
    middle[disparities] = static_cast<std::uint8_t>(p2);
    auto min_of_path = hn::Set(tag, std::uint8_t{255});
    for (int k = 0; k < disparities; k += lanes) {
        const auto neighbour = hn::Min(hn::LoadU(tag, middle + k - 1), hn::LoadU(tag, middle + k + 1));
        const auto step = hn::Min(hn::Load(tag, middle + k), hn::SaturatedAdd(neighbour, penalty));
        const auto sum = hn::Add(hn::LoadU(tag, cost + k), step);
        hn::StoreU(sum, tag, path + k);
        min_of_path = hn::Min(min_of_path, sum);
    }
    return tree ? min_by_tree(tag, min_of_path) : min_lane_by_lane(tag, min_of_path);
}

template <bool tree>
std::uint8_t continue_path(const std::uint8_t* cost, int disparities, int p1, int p2, const std::uint8_t* before,
                           std::uint8_t min_before, std::uint8_t* path) {
    const hn::ScalableTag<std::uint8_t> whole;
    const hn::CappedTag<std::uint8_t, 16> sixteen;
    return disparities % static_cast<int>(hn::MaxLanes(whole)) == 0
               ? continue_with<tree>(whole, cost, disparities, p1, p2, before, min_before, path)
               : continue_with<tree>(sixteen, cost, disparities, p1, p2, before, min_before, path);
}

VectorPaths paths() {
    return {continue_path<true>, continue_path<false>};
}

}  // namespace disparityd::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::bench {

VectorPaths vector_paths(std::int64_t target) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, paths);
    return built != nullptr ? built() : VectorPaths{};
}

}  // namespace disparityd::bench
#endif
