// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"
#include "kernels/noise/noise_level.h"

namespace disparityd::cuda {

namespace {

constexpr int block_height = 8;

// Step 8 for one pixel: its disparity, or the rejected one.
__device__ std::int16_t checked(const LeftRightMedianJob& job, int x, int y) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * job.width;
    if (job.left_right_check) {
        const int d = job.left_winner[row + x];
        const int right_x = x - d;
        const int seen = right_x >= 0 && right_x < job.width ? job.right_winner[row + right_x] : job.range.first - 1;
        if (seen < job.range.first || seen > d + 1 || seen < d - 1) {
            return static_cast<std::int16_t>((job.range.first - 1) * 16);
        }
    }
    return job.disparity[row + x];
}

template <int count>
__device__ std::int16_t median_of(std::int16_t (&values)[count]) {
#pragma unroll
    for (int pass = 0; pass <= count / 2; ++pass) {
#pragma unroll
        for (int i = pass + 1; i < count; ++i) {
            const std::int16_t smaller = min(values[pass], values[i]);
            values[i] = max(values[pass], values[i]);
            values[pass] = smaller;
        }
    }
    return values[count / 2];
}

// Steps 8 and 9: what passes the check is put into a tile with its border, where the median is taken.
template <int radius>
__global__ void left_right_median_kernel(LeftRightMedianJob job) {
    constexpr int side = 2 * radius + 1;
    constexpr int tile_width = lanes + 2 * radius;
    constexpr int tile_height = block_height + 2 * radius;
    DISPARITYD_SHARED(std::int16_t, tile, [tile_height][tile_width]);
    const int first_x = static_cast<int>(blockIdx.x) * lanes;
    const int first_y = static_cast<int>(blockIdx.y) * block_height;
    const int column = static_cast<int>(threadIdx.x);
    const int row = static_cast<int>(threadIdx.y);
    for (int i = row * lanes + column; i < tile_width * tile_height; i += lanes * block_height) {
        tile[i / tile_width][i % tile_width] = checked(job, clamp(first_x + i % tile_width - radius, 0, job.width - 1),
                                                       clamp(first_y + i / tile_width - radius, 0, job.height - 1));
    }
    __syncthreads();
    const int x = first_x + column;
    const int y = first_y + row;
    if (x >= job.width || y >= job.height) {
        return;
    }
    const auto invalid = static_cast<std::int16_t>((job.range.first - 1) * 16);
    const std::int16_t centre = tile[row + radius][column + radius];
    std::int16_t window[side * side];
#pragma unroll
    for (int i = 0; i < side * side; ++i) {
        const std::int16_t value = tile[row + i / side][column + i % side];
        window[i] = value == invalid ? centre : value;
    }
    job.out[static_cast<std::ptrdiff_t>(y) * job.width + x] = centre == invalid ? invalid : median_of(window);
}

constexpr int vote_radius = 2;
constexpr int vote_side = 2 * vote_radius + 1;
constexpr int vote_width = lanes + 2 * vote_radius;
constexpr int vote_height = block_height + 2 * vote_radius;

// The vote of step 9. What lies outside the image is rejected in the tile, and does not count either.
__global__ void vote_kernel(VoteJob job) {
    DISPARITYD_SHARED(std::int16_t, tile, [vote_height][vote_width]);
    const int first_x = static_cast<int>(blockIdx.x) * lanes;
    const int first_y = static_cast<int>(blockIdx.y) * block_height;
    const int column = static_cast<int>(threadIdx.x);
    const int row = static_cast<int>(threadIdx.y);
    for (int i = row * lanes + column; i < vote_width * vote_height; i += lanes * block_height) {
        const int x = first_x + i % vote_width - vote_radius;
        const int y = first_y + i / vote_width - vote_radius;
        const bool inside = x >= 0 && x < job.width && y >= 0 && y < job.height;
        tile[i / vote_width][i % vote_width] =
            inside ? job.in[static_cast<std::ptrdiff_t>(y) * job.width + x] : job.invalid;
    }
    __syncthreads();
    const int x = first_x + column;
    const int y = first_y + row;
    if (x >= job.width || y >= job.height) {
        return;
    }
    const int own = tile[row + vote_radius][column + vote_radius];
    int agreeing = 0;
    int sum = 0;  // of differences
#pragma unroll
    for (int i = 0; i < vote_side * vote_side; ++i) {
        const int value = tile[row + i / vote_side][column + i % vote_side];
        // Nothing below 0, so that the quotient is rounded down.
        const int difference = value - own + vote_reach;
        const bool agrees = value != job.invalid && difference >= 0 && difference <= 2 * vote_reach;
        agreeing += agrees ? 1 : 0;
        sum += agrees ? difference : 0;
    }
    const int columns = min(x, vote_radius) + 1 + min(job.width - 1 - x, vote_radius);
    const int rows = min(y, vote_radius) + 1 + min(job.height - 1 - y, vote_radius);
    const bool rejected = own == job.invalid || 100 * agreeing < vote_percent * columns * rows;
    job.out[static_cast<std::ptrdiff_t>(y) * job.width + x] =
        rejected ? job.invalid : static_cast<std::int16_t>(own + (sum + agreeing / 2) / agreeing - vote_reach);
}

}  // namespace

void left_right_median(const LeftRightMedianJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    switch (job.median) {
        case 0: launch("left-right check", shape, stream, left_right_median_kernel<0>, job); break;
        case 3: launch("median 3", shape, stream, left_right_median_kernel<1>, job); break;
        default: launch("median 5", shape, stream, left_right_median_kernel<2>, job); break;
    }
}

void vote(const VoteJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    launch("vote", shape, stream, vote_kernel, job);
}

}  // namespace disparityd::cuda
