// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/candidates.h"

namespace disparityd::cuda {

/// Pixels of a row whose results are written together. A multiple of the slots.
__host__ __device__ constexpr int batch_pixels(int packs) {
    return lanes / slots_of(packs) * slots_of(packs);
}

/// What a warp keeps of them in shared memory.
template <int packs>
struct WinnerBatch {
    static constexpr int words = packs * lanes;
    /// Candidates slots * l + 2p and the one after it in word p * lanes + l. With one word more between pixels, so that
    /// every lane can read its own pixel's at the same time.
    U16x2 sums[batch_pixels(packs)][words + 1];
    unsigned left_last_slot[batch_pixels(packs)];
};

/// Steps 6, 7 and the confidence of 13 for one row, by the warp that walks along it with all costs of a pixel in its
/// lanes.
///
/// Right winners: candidate k of left pixel x is one of right pixel x - first - k. Each slot keeps the best of its
/// right pixel so far. From pixel to pixel all of them move up by one candidate, and a right pixel that leaves the last
/// slot is complete.
template <int packs>
class WinnerRow {
public:
    static constexpr int slots = slots_of(packs);

    __device__ WinnerRow(const WinnerJob& job, int y, WinnerBatch<packs>& batch)
        : job_(job), row_(static_cast<std::ptrdiff_t>(y) * job.width), batch_(batch) {
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            right_[s] = none;
        }
        // Right pixels that are candidates of no left pixel.
        const int first_reached = -(job.range.first + last_slot);
        const int last_reached = job.width - 1 - job.range.first;
        for (int x = lane_index(); x < job.width; x += lanes) {
            if (x < first_reached || x > last_reached) {
                set_right(x, none);
            }
        }
    }

    /// From left to right; sums_of(x, phase, sums) gives the costs of a pixel, or its sums. The body is there once for
    /// each phase.
    template <typename SumsOf>
    __device__ void walk(SumsOf sums_of) {
        for (int x = 0; x < job_.width; x += slots) {
#pragma unroll
            for (int phase = 0; phase < slots; ++phase) {
                if (x + phase < job_.width) {
                    Costs<packs> sums;
                    sums_of(x + phase, phase, sums);
                    update(sums, phase);
                }
                move_up(phase);
            }
            end_pixels(slots);
        }
        finish();
    }

    /// The same with the body there once, where it is long: everything is moved for each pixel.
    template <typename SumsOf>
    __device__ void walk_pixel_by_pixel(SumsOf sums_of) {
        for (int x = 0; x < job_.width; ++x) {
            Costs<packs> sums;
            sums_of(x, sums);
            update(sums, 0);
            move_up(0);
            const unsigned first = right_[slots - 1];
#pragma unroll
            for (int s = slots - 1; s > 0; --s) {
                right_[s] = right_[s - 1];
            }
            right_[0] = first;
            end_pixels(1);
        }
        finish();
    }

private:
    static constexpr unsigned none = 0xffffffff;
    static constexpr int last_slot = slots * lanes - 1;

    // A cost and its candidate: of equal costs the one with the smaller k is the less.
    __device__ static unsigned key(unsigned cost, int k) {
        return cost << 16 | static_cast<unsigned>(k);
    }
    __device__ static int k_of(unsigned key) {
        return static_cast<int>(key & 0xffff);
    }
    __device__ static int cost_of(unsigned key) {
        return static_cast<int>(key >> 16);
    }

    __device__ void set_right(int x, unsigned key) {
        const bool found = cost_of(key) < static_cast<int>(unreachable);
        job_.right_winner[row_ + x] = static_cast<std::int16_t>(job_.range.first + (found ? k_of(key) : -1));
    }

    __device__ void update(const Costs<packs>& sums, int phase) {
        unsigned best = none;
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            const unsigned cost = s % 2 == 0 ? sums[s / 2] & 0xffff : sums[s / 2] >> 16;
            const unsigned here = key(cost, candidate<packs>(s));
            best = min(best, here);
            unsigned& right = right_[renamed<packs, 1>(s, phase)];
            right = min(right, here);
        }
        best = min_of_warp(best);
        const int place = pixels_ + phase;
        if (lane_index() == place) {
            best_ = best;
        }
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            batch_.sums[place][p * lanes + lane_index()] = sums[p];
        }
    }

    // Who leaves the last slot of a lane comes to the first one of the next lane.
    __device__ void move_up(int phase) {
        unsigned& last = right_[renamed<packs, 1>(slots - 1, phase)];
        const unsigned moved = __shfl_sync(all_lanes, last, (lane_index() + lanes - 1) % lanes);
        if (lane_index() == 0) {
            batch_.left_last_slot[pixels_ + phase] = moved;
        }
        last = lane_index() == 0 ? none : moved;
    }

    __device__ void end_pixels(int count) {
        pixels_ += count;
        if (pixels_ == batch_pixels(packs)) {
            write_batch();
        }
    }

    __device__ void finish() {
        if (pixels_ > 0) {
            write_batch();
        }
#pragma unroll
        for (int s = 0; s < slots; ++s) {
            const int x = x_ - job_.range.first - candidate<packs>(s);
            if (x >= 0 && x < job_.width) {
                set_right(x, right_[s]);
            }
        }
    }

    // A lane for each pixel.
    __device__ void write_batch() {
        __syncwarp();
        const int lane = lane_index();
        if (lane < pixels_) {
            if (x_ + lane < job_.width) {
                write_left(batch_.sums[lane]);
            }
            const int right_x = x_ + lane - job_.range.first - last_slot;
            if (right_x >= 0 && right_x < job_.width) {
                set_right(right_x, batch_.left_last_slot[lane]);
            }
        }
        __syncwarp();
        x_ += pixels_;
        pixels_ = 0;
    }

    __device__ void write_left(U16x2* sums) const {
        const int k = k_of(best_);
        const int least = cost_of(best_);
        const bool first = k == 0;
        const bool last = k == job_.range.count - 1;
        remove(sums, k);
        const int minus = first ? 0 : remove(sums, k - 1);
        const int plus = last ? 0 : remove(sums, k + 1);
        const int second = min_of(sums);
        const bool no_minimum = (first || minus == least) && (last || plus == least);
        const bool ambiguous = job_.uniqueness > 0 && second * (100 - job_.uniqueness) <= least * 100;
        const bool rejected = ambiguous || (job_.local_extrema && no_minimum);
        const int winner = job_.range.first + k;
        const int offset = job_.subpixel && !first && !last ? offset16(minus, least, plus) : 0;
        const std::ptrdiff_t i = row_ + x_ + lane_index();
        job_.left_winner[i] = static_cast<std::int16_t>(winner);
        job_.disparity[i] = static_cast<std::int16_t>(rejected ? (job_.range.first - 1) * 16 : 16 * winner + offset);
        const int confidence = second == 0 ? 1 : 1 + 254 * (second - least) / second;
        job_.confidence[i] = static_cast<std::uint8_t>(rejected ? 0 : confidence);
    }

    // The sum of a candidate, which then no longer counts.
    __device__ static int remove(U16x2* sums, int k) {
        const int slot = k % slots;
        U16x2& both = sums[slot / 2 * lanes + k / slots];
        const int shift = slot % 2 * 16;
        const int sum = static_cast<int>(both >> shift & 0xffff);
        both = (both & ~(0xffffU << shift)) | unreachable << shift;
        return sum;
    }

    __device__ static int min_of(const U16x2* sums) {
        U16x2 least = splat_u16x2(unreachable);
#pragma unroll 8
        for (int w = 0; w < WinnerBatch<packs>::words; ++w) {
            least = min_u16x2(least, sums[w]);
        }
        return static_cast<int>(min_half(least));
    }

    // The equiangular fit.
    __device__ static int offset16(int minus, int least, int plus) {
        const int steeper = max(minus, plus) - least;
        if (steeper == 0) {
            return 0;
        }
        const int difference = minus - plus;
        const int magnitude = (16 * (difference < 0 ? -difference : difference) + steeper) / (2 * steeper);
        return difference >= 0 ? magnitude : -magnitude;
    }

    const WinnerJob& job_;
    std::ptrdiff_t row_;
    WinnerBatch<packs>& batch_;
    int x_ = 0;       // the batch's first pixel
    int pixels_ = 0;  // of the batch so far
    unsigned right_[slots];
    unsigned best_ = 0;  // of the pixel of the batch that is this lane's
};

constexpr int block_rows = 2;  // warps of a block in the kernels that walk along rows

inline Shape rows_shape(int height) {
    return {dim3(blocks_for(height, block_rows)), dim3(lanes, block_rows)};
}

__device__ inline int row_of_warp() {
    return static_cast<int>(blockIdx.x) * block_rows + warp_index();
}

}  // namespace disparityd::cuda
