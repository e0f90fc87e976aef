// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

/// Steps 6, 7 and the confidence of 12 for one row, by the warp that walks along it with all costs of a pixel in its
/// lanes.
///
/// Right winners: candidate k of left pixel x is one of right pixel x - first - k. Each slot keeps the best of its
/// right pixel so far; from pixel to pixel all of them move up by one candidate, and who leaves the last one has met
/// all.
template <int packs>
class WinnerRow {
public:
    __device__ WinnerRow(const WinnerJob& job, int y)
        : job_(job), row_(static_cast<std::ptrdiff_t>(y) * job.width), x_(0) {
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            right_[s] = none;
        }
        // Right pixels without a candidate inside the left image.
        const int first_met = -(job.range.first + job.range.count - 1);
        const int last_met = job.width - 1 - job.range.first;
        for (int x = lane_index(); x < job.width; x += lanes) {
            if (x < first_met || x > last_met) {
                set_right(x, none);
            }
        }
    }

    /// The next pixel of the row, from the first one on.
    __device__ void next(const Costs<packs>& sums) {
        unsigned key[slots];
        unsigned best = none;
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            key[s] = (s % 2 == 0 ? sums[s / 2] & 0xffff : sums[s / 2] >> 16) << 8 | candidate(s);
            best = min(best, key[s]);
        }
        best = least_of_warp(best);  // of equal costs the one with the smallest k
        look_around(key, best);
        meet_right(key);
        const bool batch_full = x_ % lanes == lanes - 1 || x_ == job_.width - 1;
        if (batch_full && lane_index() <= x_ % lanes) {
            write_left();
        }
        ++x_;
    }

    /// After the last pixel.
    __device__ void finish() {
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            const int x = x_ - job_.range.first - static_cast<int>(candidate(s));
            if (static_cast<int>(candidate(s)) < job_.range.count && x >= 0 && x < job_.width) {
                set_right(x, right_[s]);
            }
        }
    }

private:
    static constexpr int slots = slots_of(packs);
    static constexpr unsigned none = 0xffffffff;

    __device__ static unsigned candidate(int slot) {
        return static_cast<unsigned>(slot * lanes + lane_index());
    }

    __device__ void set_right(int x, unsigned key) {
        const int winner = key == none ? job_.range.first - 1 : job_.range.first + static_cast<int>(key & 255);
        job_.right_winner[row_ + x] = static_cast<std::int16_t>(winner);
    }

    // What the result of a pixel follows from stays in the lane of its place in a batch of 32: divisions are then done
    // for 32 pixels at once.
    __device__ void look_around(const unsigned (&key)[slots], unsigned best) {
        unsigned second = unreachable;
        unsigned around = 0;
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            const unsigned cost = key[s] >> 8;
            const unsigned distance = candidate(s) - (best & 255) + 1;  // 1 is the winner
            second = min(second, distance > 2 ? cost : unreachable);
            around |= distance == 0 ? cost << 16 : distance == 2 ? cost : 0;
        }
        second = least_of_warp(second);
        around = bits_of_warp(around);
        if (lane_index() == x_ % lanes) {
            best_ = best;
            second_ = static_cast<int>(second);
            around_ = around;
        }
    }

    __device__ void meet_right(const unsigned (&key)[slots]) {
        const int last = job_.range.count - 1;
        const int leaving_x = x_ - job_.range.first - last;
        const int lane = lane_index();
        unsigned moved[slots];
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            right_[s] = min(right_[s], key[s]);
            if (static_cast<int>(candidate(s)) == last && leaving_x >= 0 && leaving_x < job_.width) {
                set_right(leaving_x, right_[s]);
            }
            moved[s] = __shfl_sync(all_lanes, right_[s], (lane + lanes - 1) % lanes);
        }
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            right_[s] = lane > 0 ? moved[s] : s > 0 ? moved[s > 0 ? s - 1 : 0] : none;
        }
    }

    __device__ void write_left() {
        const int k = static_cast<int>(best_ & 255);
        const int least = static_cast<int>(best_ >> 8);
        const int before = static_cast<int>(around_ >> 16);
        const int after = static_cast<int>(around_ & 0xffff);
        const bool first = k == 0;
        const bool last = k == job_.range.count - 1;
        const bool no_minimum = (first || before == least) && (last || after == least);
        const bool ambiguous = job_.uniqueness > 0 && second_ * (100 - job_.uniqueness) <= least * 100;
        const bool rejected = ambiguous || (job_.local_extrema && no_minimum);
        const int winner = job_.range.first + k;
        const int offset = job_.subpixel && !first && !last ? offset16(before, least, after) : 0;
        const std::ptrdiff_t i = row_ + x_ - x_ % lanes + lane_index();
        job_.left_winner[i] = static_cast<std::int16_t>(winner);
        job_.disparity[i] = static_cast<std::int16_t>(rejected ? (job_.range.first - 1) * 16 : 16 * winner + offset);
        const int confidence = second_ == 0 ? 1 : 1 + 254 * (second_ - least) / second_;
        job_.confidence[i] = static_cast<std::uint8_t>(rejected ? 0 : confidence);
    }

    // The equiangular fit.
    __device__ static int offset16(int before, int least, int after) {
        const int steeper = max(before, after) - least;
        if (steeper == 0) {
            return 0;
        }
        const int difference = before - after;
        const int magnitude = (16 * (difference < 0 ? -difference : difference) + steeper) / (2 * steeper);
        return difference >= 0 ? magnitude : -magnitude;
    }

    const WinnerJob& job_;
    std::ptrdiff_t row_;
    int x_;
    unsigned right_[slots];
    unsigned best_ = 0;
    int second_ = 0;
    unsigned around_ = 0;
};

constexpr int block_rows = 2;  // warps of a block in the kernels that walk along rows

inline Shape rows_shape(int height) {
    return {dim3(blocks_for(height, block_rows)), dim3(lanes, block_rows)};
}

__device__ inline int row_of_warp() {
    return static_cast<int>(blockIdx.x * block_rows + threadIdx.y);
}

}  // namespace disparityd::cuda
