// SPDX-License-Identifier: Apache-2.0
// Step 5 of docs/algorithm.md, row by row: in which order pixels and their minima are worked on.
#if defined(DISPARITYD_CPU_SGM_PATH_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_PATH_ROWS_INL_H_
#undef DISPARITYD_CPU_SGM_PATH_ROWS_INL_H_
#else
#define DISPARITYD_CPU_SGM_PATH_ROWS_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/sgm/path_pixels-inl.h"
#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/cpu/simd/image_rows-inl.h"
#include "kernels/cpu/simd/transpose_min-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// A row, or two rows, the second some pixels behind the first.
template <class Tag, int registers, int rows_at_once, bool streaming, PathVariant variant>
class PathRows {
    using Pixels = PathPixels<Tag, registers, streaming, variant>;
    using State = typename Pixels::State;
    static constexpr int candidates = Pixels::candidates;
    static constexpr int paths_from_previous_row = Pixels::paths_from_previous_row;
    static constexpr int state_bytes = Pixels::state_bytes;

public:
    PathRows(const MatchGeometry& geometry, const SweepPass& pass, const PathRow& previous_row)
        : width_(geometry.width), previous_row_(previous_row), pixels_(geometry, pass, previous_row) {}

    /// What a row carries from one call to the next goes to `state`.
    void run(const SweepRow* rows, bool from_right, SweepSteps steps, std::uint8_t* state) {
        DISPARITYD_UNROLL
        for (int j = 0; j < rows_at_once; ++j) {
            pixels_.begin(states_[j], rows[j], from_right);
            if (steps.first > 0) {
                pixels_.restore(states_[j], state + j * state_bytes);
            }
        }
        // Rows begin one after the other and end so; in between all are inside the image. A row may end inside a block.
        const int whole_blocks = width_ / min_block * min_block;
        int t = steps.first;
        const auto go_to = [&](int end, auto go) {
            end = std::min(end, steps.end);
            if (t < end) {
                go(t, end);
                t = end;
            }
        };
        const auto at_border = [&](int first, int end) {
            for (int block = first; block < end; block += min_block) {
                block_at_border(block);
            }
        };
        if constexpr (rows_at_once == 2) {  // the first row alone, until it is ahead
            go_to(std::min(row_lag, whole_blocks), [&](int first, int end) { blocks_inside<0, 1>(first, end); });
        }
        go_to(whole_blocks, [&](int first, int end) { blocks_inside<0, rows_at_once>(first, end); });
        if constexpr (rows_at_once == 2) {
            go_to(std::max(rounded_up(width_, min_block), row_lag), at_border);  // the end of the first row
            go_to(whole_blocks + row_lag, [&](int first, int end) {              // the second row alone
                reduce_at_border(first - min_block);                             // the first row's last minima
                blocks_inside<1, 1>(first, end);
            });
        }
        go_to(steps.end, at_border);  // the end of the last row
        if (t == steps_of(width_, rows_at_once)) {
            reduce_at_border(t - min_block);
            return;
        }
        DISPARITYD_UNROLL
        for (int j = 0; j < rows_at_once; ++j) {
            pixels_.save(states_[j], state + j * state_bytes);
        }
    }

private:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

    // min L of the 16 pixels from p on. Half of 64 lanes at a time: the first minimum of a pixel then needs no
    // shuffles.
    HWY_INLINE hn::Vec<hn::FixedTag<std::uint8_t, 16>> min_of(int path, int p) const {
        using Part = std::conditional_t<lanes == 64, hn::FixedTag<std::uint8_t, std::min(lanes, 32)>, Tag>;
        constexpr int part_lanes = static_cast<int>(hn::MaxLanes(Part()));
        const std::uint8_t* costs = previous_row_.costs[path] + static_cast<std::ptrdiff_t>(p) * candidates;
        return transpose_min(Part(), [&](int i) {
            auto v = hn::Load(Part(), costs + i * candidates);
            DISPARITYD_UNROLL
            for (int at = part_lanes; at < candidates; at += part_lanes) {
                v = hn::Min(v, hn::Load(Part(), costs + i * candidates + at));
            }
            return v;
        });
    }

    // `count` rows from `first_row` on. The minima of a block are taken while the next one is worked on, spread among
    // its pixels, those of the first row first: the last pixel of the second row needs the first of them.
    template <int first_row, int count>
    void blocks_inside(int first, int end) {
        const hn::FixedTag<std::uint8_t, 16> block;
        constexpr int reductions = paths_from_previous_row * count;
        constexpr int share = count == 1 ? 4 : 2;  // pixels per reduction
        // A copy that nobody else can see and that is not indexed at run time stays in registers.
        PathRows local = *this;
        PathOffsets offsets[count];
        for (int t = first; t < end; t += min_block) {
            DISPARITYD_UNROLL
            for (int j = 0; j < count; ++j) {
                begin_block(first_row + j, t, offsets[j]);
            }
            for (int i = 0; i < min_block / share; ++i) {
                DISPARITYD_UNROLL
                for (int k = 0; k < share; ++k) {
                    int p[count];
                    DISPARITYD_UNROLL
                    for (int j = 0; j < count; ++j) {
                        p[j] = t + i * share + k - row_lag * (first_row + j);
                    }
                    local.pixels_.template pixels<count>(local.states_ + first_row, p, offsets, i * share + k);
                }
                const int row = i / paths_from_previous_row;
                const int p = t - min_block - row_lag * (first_row + row);
                if (i < reductions && p >= 0) {
                    const int path = Pixels::path_from_previous_row(i % paths_from_previous_row);
                    hn::StoreU(min_of(path, p), block, previous_row_.least[path] + p);
                    if (path == 2 && row + 1 < count) {
                        begin_block(row + 1, t, offsets[row + 1]);
                    }
                }
            }
        }
        // One by one: a copy of them all would be a copy of memory.
        DISPARITYD_UNROLL
        for (int j = first_row; j < first_row + count; ++j) {
            states_[j] = local.states_[j];
        }
    }

    void block_at_border(int t) {
        if (t > 0) {
            reduce_at_border(t - min_block);
        }
        PathOffsets offsets[rows_at_once];
        for (int j = 0; j < rows_at_once; ++j) {
            begin_block(j, t, offsets[j]);
        }
        for (int i = 0; i < min_block; ++i) {
            for (int j = 0; j < rows_at_once; ++j) {
                const int p = t + i - row_lag * j;
                if (p >= 0 && p < width_) {
                    pixels_.template pixels<1>(&states_[j], &p, &offsets[j], i);
                }
            }
        }
    }

    // The offsets of row j at step t. Of the last pixel of a second row they are right only when the minima of the
    // first row's previous block are there.
    HWY_INLINE void begin_block(int j, int t, PathOffsets& offsets) const {
        const int p = t - row_lag * j;
        if (p >= 0 && p < width_) {
            pixels_.take_offsets(states_[j], p, offsets);
        }
    }

    void reduce_at_border(int t) const {
        const hn::FixedTag<std::uint8_t, 16> block;
        for (int j = 0; j < rows_at_once; ++j) {
            const int p = t - row_lag * j;
            const int first = std::max(p, 0);
            const int last = std::min(p + min_block, width_);
            for (int i = 0; i < paths_from_previous_row && first < last; ++i) {
                const int path = Pixels::path_from_previous_row(i);
                alignas(16) std::uint8_t least[min_block];
                hn::Store(min_of(path, p), block, least);
                std::copy(least + (first - p), least + (last - p), previous_row_.least[path] + first);
            }
        }
    }

    int width_;
    PathRow previous_row_;
    Pixels pixels_;
    State states_[rows_at_once];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
