// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/matching_cost.h"
#include "kernels/cuda/winner_row.h"

namespace disparityd::cuda {

namespace {

constexpr int radius_x = 4;
constexpr int radius_y = 3;
constexpr int window_width = 2 * radius_x + 1;
constexpr int window_height = 2 * radius_y + 1;
constexpr unsigned outside = window_width * window_height * 255;

template <Cost cost, int packs>
__global__ void __launch_bounds__(block_rows* lanes) census_winners_kernel(CensusWords words, WinnerJob winner) {
    DISPARITYD_SHARED(WinnerBatch<packs>, batches, [block_rows]);
    const int y = row_of_warp();
    if (y >= winner.height) {
        return;
    }
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * winner.width;
    const CandidateBounds<packs> bounds(winner.range, winner.width);
    WordsAlongRow<cost, packs, 1> right(words_of<cost>(words.right) + row, bounds, 0);
    WinnerRow<packs> winners(winner, y, batches[threadIdx.y]);
    winners.walk([&](int x, int phase, Costs<packs>& costs) {
        right.next(words_of<cost>(words.left)[row + x], x, phase, costs);
    });
}

// Step 2 along one row: the window's sum is kept up by the column that enters and the one that leaves, which lie in a
// ring of the window's width. Every lane keeps its own candidates there, so nobody waits for anybody.
template <int packs>
class SadRow {
public:
    using Ring = U16x2 (&)[window_width][packs][lanes];

    __device__ SadRow(View<const std::uint8_t> left, View<const std::uint8_t> right,
                      const CandidateBounds<packs>& bounds, int y, Ring ring)
        : left_(left), right_(right), bounds_(bounds), y_(y), ring_(ring) {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            sums_[p] = 0;
        }
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            const int x = clamp(dx, 0, left.width - 1);
            if (dx >= 0 && dx < left.width) {
                make_column(x);
            }
        }
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            change(clamp(dx, 0, left.width - 1), 1);
        }
    }

    __device__ void costs(int x, Costs<packs>& out) const {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            out[p] = sums_[p];
        }
        if (!bounds_.all_inside(x)) {
            bounds_.limit(x, outside, out);
        }
    }

    /// From pixel x to the one after it.
    __device__ void advance(int x) {
        const int entering = x + 1 + radius_x;
        change(max(x - radius_x, 0), -1);
        if (entering < left_.width) {
            make_column(entering);
        }
        change(min(entering, left_.width - 1), 1);
    }

private:
    __device__ void change(int x, int sign) {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            const U16x2 column = ring_[x % window_width][p][lane_index()];
            sums_[p] = sign > 0 ? sums_[p] + column : sums_[p] - column;
        }
    }

    __device__ void make_column(int x) {
        unsigned sums[slots_of(packs)] = {};
        for (int dy = -radius_y; dy <= radius_y; ++dy) {
            const int window_y = clamp(y_ + dy, 0, left_.height - 1);
            const std::uint8_t* right = right_.row(window_y);
            const unsigned pixel = left_.at(x, window_y);
#pragma unroll
            for (int s = 0; s < slots_of(packs); ++s) {
                sums[s] = __usad(pixel, right[bounds_.column(x, s)], sums[s]);
            }
        }
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            ring_[x % window_width][p][lane_index()] = sums[2 * p] | sums[2 * p + 1] << 16;
        }
    }

    View<const std::uint8_t> left_;
    View<const std::uint8_t> right_;
    const CandidateBounds<packs>& bounds_;
    int y_;
    Ring ring_;
    Costs<packs> sums_;
};

template <int packs>
__global__ void __launch_bounds__(block_rows* lanes)
    sad_winners_kernel(View<const std::uint8_t> left, View<const std::uint8_t> right, WinnerJob winner) {
    DISPARITYD_SHARED(U16x2, rings, [block_rows][window_width][packs][lanes]);
    DISPARITYD_SHARED(WinnerBatch<packs>, batches, [block_rows]);
    const int y = row_of_warp();
    if (y >= winner.height) {
        return;
    }
    const CandidateBounds<packs> bounds(winner.range, winner.width);
    SadRow<packs> sad(left, right, bounds, y, rings[threadIdx.y]);
    WinnerRow<packs> winners(winner, y, batches[threadIdx.y]);
    winners.walk_pixel_by_pixel([&](int x, Costs<packs>& costs) {
        sad.costs(x, costs);
        sad.advance(x);
    });
}

}  // namespace

void census_winners(Cost cost, CensusWords words, const WinnerJob& winner, cudaStream_t stream) {
    with_cost(cost, [&](auto of_cost) {
        with_packs(winner.range.count, [&](auto packs) {
            launch("census winners", rows_shape(winner.height), stream,
                   census_winners_kernel<decltype(of_cost)::value, decltype(packs)::value>, words, winner);
        });
    });
}

void sad_winners(View<const std::uint8_t> left, View<const std::uint8_t> right, const WinnerJob& winner,
                 cudaStream_t stream) {
    with_packs(winner.range.count, [&](auto packs) {
        launch("SAD winners", rows_shape(winner.height), stream, sad_winners_kernel<decltype(packs)::value>, left,
               right, winner);
    });
}

}  // namespace disparityd::cuda
