// SPDX-License-Identifier: Apache-2.0
// Step 5 of docs/algorithm.md, pixel by pixel: the paths of one sweep, one along the row and three (of 4 paths, one)
// from the previous row.
//
// A path arrives at a pixel as N(d) = min(L(d) - min L, P2) of the pixel it comes from; M(d) = min(N(d), N(d-1) + P1,
// N(d+1) + P1) is what it adds there: L(d) = C(d) + M(d). Where P2 is small all these have a bias, see
// path_offsets-inl.h.
#if defined(DISPARITYD_CPU_SGM_PATH_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_PATH_PIXELS_INL_H_
#undef DISPARITYD_CPU_SGM_PATH_PIXELS_INL_H_
#else
#define DISPARITYD_CPU_SGM_PATH_PIXELS_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/sgm/path_offsets-inl.h"
#include "kernels/cpu/sgm/path_sums-inl.h"
#include "kernels/cpu/sgm/path_variant.h"
#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/simd/prefetch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// One pixel after the other of rows on their way.
template <class Tag, int registers, bool streaming, PathVariant variant>
class PathPixels {
    using V = hn::Vec<Tag>;
    using Sums = PathSums<Tag, registers, variant.u16_sums>;
    static constexpr bool less_p1 = !variant.any_p2;
    static_assert(variant.any_p2 || !variant.u16_sums);
    // With 16 vector registers matching costs are better loaded again for each path than stored and restored.
    static constexpr bool loads_again = HWY_ARCH_X86 && (HWY_TARGET > HWY_AVX3) && registers > 2 && !variant.any_p2;

public:
    static constexpr int candidates = registers * static_cast<int>(hn::MaxLanes(Tag()));
    /// Of the paths of PathRow those that there are.
    static constexpr int paths_from_previous_row = variant.diagonals ? 3 : 1;
    static constexpr int path_from_previous_row(int i) { return variant.diagonals ? i : 1; }

    /// A row on its way. The path along the row is kept as L with min L beside it: the minimum, a long chain of
    /// dependent operations, is then needed late in the next pixel only.
    struct State {
        // Written out: GCC compiles an implicit one for the baseline, which cannot call what is of this instruction
        // set.
        State() {}

        V along[registers];
        V diagonal[registers];
        V least;
        const std::uint8_t* costs;
        std::uint8_t* sums;
        const std::uint8_t* others;
        const std::uint8_t* prefetch[2];
        std::ptrdiff_t prefetch_step;
        const std::uint8_t* p2_rows[4];
    };

    PathPixels(const MatchGeometry& geometry, const SweepPass& pass, const PathRow& previous_row)
        : width_(geometry.width),
          step_(pass.direction * candidates),
          p1_(hn::Set(tag_, static_cast<std::uint8_t>(pass.p1))),
          less_(static_cast<std::uint8_t>(paths_from_previous_row * pass.p1)),
          none_(hn::Set(tag_, std::uint8_t{255})),
          previous_row_(previous_row) {
        if constexpr (variant.any_p2) {
            set_padding(geometry.range.count);
        } else {
            padding_[0] = hn::Zero(tag_);
        }
    }

    void begin(State& state, const SweepRow& row, bool from_right) const {
        const std::ptrdiff_t first = from_right ? static_cast<std::ptrdiff_t>(width_ - 1) * candidates : 0;
        state.costs = row.costs + first;
        state.sums = row.sums + first * variant.sum_bytes();
        state.others = variant.adds ? row.others + first : nullptr;
        state.prefetch_step = row.prefetch[0] == nullptr ? 1 : variant.sum_bytes();
        state.prefetch[0] = row.prefetch[0] == nullptr ? state.costs : row.prefetch[0] + first * variant.sum_bytes();
        state.prefetch[1] = row.prefetch[1] == nullptr ? state.costs : row.prefetch[1] + first;
        std::copy_n(row.p2_rows, 4, state.p2_rows);
        state.least = hn::Zero(tag_);
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            state.along[r] = hn::Zero(tag_);
            state.diagonal[r] = variant.any_p2 ? hn::Zero(tag_) : hn::Set(tag_, bias_for(row.p2_rows[0][0]));
        }
    }

    /// The offsets of the block of pixels from p on.
    HWY_INLINE void take_offsets(const State& state, int p, PathOffsets& offsets) const {
        if constexpr (!variant.any_p2) {
            offsets.take<variant.diagonals>(previous_row_, state.p2_rows, less_, p);
        }
    }

    /// One pixel in each of `count` rows, row j at position p[j]; step by step side by side, so that the processor has
    /// independent work while one row waits for its minimum. It is the i-th of its block.
    template <int count>
    HWY_INLINE void pixels(State* states, const int* p, const PathOffsets* blocks, int i) const {
        V cost[count][registers];
        Sums sums[count];
        V n[registers];
        V m[registers];
        DISPARITYD_UNROLL
        for (int j = 0; j < count; ++j) {
            along_row(states[j], p[j], blocks[j], i, cost[j], sums[j]);
        }
        DISPARITYD_UNROLL
        for (int j = 0; j < count; ++j) {
            load_previous_row(states[j], 1, p[j], p[j], blocks[j], i, n);
            continue_path<less_p1>(n, m);
            finish_path(states[j], 1, p[j], m, cost[j], sums[j]);
        }
        if constexpr (variant.diagonals) {
            DISPARITYD_UNROLL
            for (int j = 0; j < count; ++j) {
                load_previous_row(states[j], 2, p[j] + 1, p[j], blocks[j], i, n);
                continue_path<less_p1>(n, m);
                finish_path(states[j], 2, p[j], m, cost[j], sums[j]);
            }
        }
        DISPARITYD_UNROLL
        for (int j = 0; j < count; ++j) {
            if constexpr (variant.diagonals) {
                // The previous pixel overwrote its own entry: what this one needs was taken from there just in time.
                continue_path<less_p1>(states[j].diagonal, m);
                load_previous_row(states[j], 0, p[j], p[j] + 1, blocks[j], i, states[j].diagonal);
                finish_path(states[j], 0, p[j], m, cost[j], sums[j]);
            }
            sums[j].template store<streaming>(states[j].sums +
                                              static_cast<std::ptrdiff_t>(p[j]) * step_ * variant.sum_bytes());
        }
    }

    /// Bytes of a state while nobody works on its row.
    static constexpr int state_bytes = 2 * candidates + static_cast<int>(hn::MaxLanes(Tag()));

    void save(const State& state, std::uint8_t* to) const {
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            hn::Store(state.along[r], tag_, to + r * lanes());
            hn::Store(state.diagonal[r], tag_, to + candidates + r * lanes());
        }
        hn::Store(state.least, tag_, to + 2 * candidates);
    }

    void restore(State& state, const std::uint8_t* from) const {
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            state.along[r] = hn::Load(tag_, from + r * lanes());
            state.diagonal[r] = hn::Load(tag_, from + candidates + r * lanes());
        }
        state.least = hn::Load(tag_, from + 2 * candidates);
    }

private:
    // 255 where there is no candidate: out of reach of all others, and it stays there.
    void set_padding(int count) {
        for (int r = 0; r < registers; ++r) {
            alignas(64) std::uint8_t lane_padding[hn::MaxLanes(Tag())];
            for (int lane = 0; lane < lanes(); ++lane) {
                lane_padding[lane] = registers * lane + r < count ? std::uint8_t{0} : std::uint8_t{255};
            }
            padding_[r] = hn::Load(tag_, lane_padding);
        }
    }

    // M from N, for one path; with `less_p1`, and N with its bias, less by P1: P1 is taken from N(d) instead of added
    // to its neighbours, which needs no saturation.
    template <bool less_p1>
    HWY_INLINE void continue_path(const V* n, V* m) const {
        const V below = path_from_below<registers>(tag_, n[registers - 1], none_);
        const V above = path_from_above<registers>(tag_, n[0], none_);
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const V minus = r == 0 ? below : n[r - 1];
            const V plus = r == registers - 1 ? above : n[r + 1];
            const V step = hn::Min(minus, plus);
            m[r] = less_p1 ? hn::Min(hn::Sub(n[r], p1_), step) : hn::Min(n[r], hn::SaturatedAdd(step, p1_));
        }
    }

    // N of the pixel at `from` of the previous row, for the pixel at `to`; `block` has the offsets of the pixel in
    // work, the i-th of its block.
    HWY_INLINE void load_previous_row(const State& state, int path, int from, int to, const PathOffsets& block, int i,
                                      V* n) const {
        const std::uint8_t* costs = previous_row_.costs[path] + static_cast<std::ptrdiff_t>(from) * candidates;
        if constexpr (variant.any_p2) {
            const V least = hn::Set(tag_, previous_row_.least[path][from]);
            const V p2 = hn::Set(tag_, state.p2_rows[path][to]);
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                n[r] = hn::Min(hn::Sub(hn::Load(tag_, costs + r * lanes()), least), p2);
            }
        } else {
            const V offset = broadcast(tag_, &block.from_previous_row[path][i]);
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                n[r] = hn::SaturatedAdd(hn::Load(tag_, costs + r * lanes()), offset);
            }
        }
    }

    static constexpr int lanes() { return static_cast<int>(hn::MaxLanes(Tag())); }

    // L = M + C.
    static HWY_INLINE V path_cost(V m, V cost) {
        if constexpr (variant.any_p2) {
            return hn::SaturatedAdd(m, cost);
        } else {
            return hn::Add(m, cost);
        }
    }

    HWY_INLINE void finish_path(const State& state, int path, int p, const V* m, const V* cost, Sums& sums) const {
        std::uint8_t* costs = previous_row_.costs[path] + static_cast<std::ptrdiff_t>(p) * candidates;
        const std::uint8_t* again = state.costs + static_cast<std::ptrdiff_t>(p) * step_;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            sums.add(r, m[r]);
            const V matching_cost = loads_again ? hn::Load(tag_, again + r * lanes()) : cost[r];
            hn::Store(path_cost(m[r], matching_cost), tag_, costs + r * lanes());
        }
    }

    HWY_INLINE void along_row(State& state, int p, const PathOffsets& block, int i, V* cost, Sums& sums) const {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(p) * step_;
        V m[registers];
        continue_path<false>(state.along, m);
        V limit;
        V sum_bias;
        if constexpr (variant.any_p2) {
            limit = hn::Add(state.least, hn::Set(tag_, state.p2_rows[3][p]));
        } else {
            limit = hn::Sub(broadcast(tag_, &block.along[i]), state.least);
            sum_bias = broadcast(tag_, &block.sum_bias[i]);
        }
        V least = none_;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const std::ptrdiff_t offset = at + r * lanes();
            cost[r] = hn::Load(tag_, state.costs + offset);
            if (!streaming && r * lanes() % cache_line == 0) {
                prefetch(state, offset);
            }
            if constexpr (variant.any_p2) {
                cost[r] = hn::Or(cost[r], padding_[r]);
                m[r] = hn::Sub(hn::Min(m[r], limit), state.least);
                sums.set(r, m[r]);
            } else {
                m[r] = hn::SaturatedAdd(m[r], limit);
                const V sum = hn::Sub(m[r], sum_bias);
                sums.set(r, variant.adds ? hn::Add(sum, hn::Load(tag_, state.others + offset)) : sum);
            }
            state.along[r] = path_cost(m[r], cost[r]);
            least = r == 0 ? state.along[r] : hn::Min(least, state.along[r]);
        }
        state.least = broadcast_min(tag_, least);
    }

    static HWY_INLINE void prefetch(const State& state, std::ptrdiff_t offset) {
        prefetch_to_second_level(state.prefetch[0] + offset * state.prefetch_step);
        if constexpr (variant.u16_sums) {
            prefetch_to_second_level(state.prefetch[0] + offset * state.prefetch_step + cache_line);
        }
        if constexpr (!variant.adds) {  // winners ask for costs there
            prefetch_to_second_level(state.prefetch[1] + offset);
        }
    }

    const Tag tag_{};
    int width_;
    std::ptrdiff_t step_;
    V p1_;
    std::uint8_t less_;  // with less_p1, what the M of all paths from the previous row lack together
    V none_;
    V padding_[variant.any_p2 ? registers : 1];  // with any_p2
    PathRow previous_row_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
