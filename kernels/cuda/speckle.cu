// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"
#include "kernels/texture.h"

namespace disparityd::cuda {

namespace {

// An image is cut into tiles as wide as a warp, with a thread for each pixel.
constexpr int tile_height = 16;
constexpr int tile_pixels = lanes * tile_height;

constexpr int block_threads = 256;

__device__ int thread_index() {
    return static_cast<int>(blockIdx.x) * block_threads + static_cast<int>(threadIdx.x);
}

// A region is a tree whose root is its smallest index: every pixel names one of its region that is smaller, or itself.
__device__ std::uint32_t root_of(const volatile std::uint32_t* labels, std::uint32_t pixel) {
    for (std::uint32_t parent = labels[pixel]; parent != pixel; parent = labels[pixel]) {
        pixel = parent;
    }
    return pixel;
}

// Others may join the same regions meanwhile: a root that got another parent since it was looked up is taken up again.
__device__ void join(std::uint32_t* labels, std::uint32_t a, std::uint32_t b) {
    for (;;) {
        a = root_of(labels, a);
        b = root_of(labels, b);
        if (a == b) {
            return;
        }
        const std::uint32_t larger = max(a, b);
        const std::uint32_t smaller = min(a, b);
        const std::uint32_t parent = atomicMin(&labels[larger], smaller);
        if (parent == larger) {
            return;
        }
        a = parent;
        b = smaller;
    }
}

__device__ bool belong_together(const SpeckleJob& job, std::int16_t a, std::int16_t b) {
    const int difference = a > b ? a - b : b - a;
    return a != job.invalid && b != job.invalid && difference <= job.max_step;
}

// The first lane of this lane's run in a row of a tile: `linked` has a bit for each lane that belongs to the one
// before.
__device__ int run_begin(unsigned linked) {
    const unsigned up_to_this = all_lanes >> (lanes - 1 - static_cast<int>(threadIdx.x));
    return lanes - 1 - __clz(static_cast<int>(~linked & up_to_this));
}

// How many lanes belong to the run that begins with this lane.
__device__ unsigned run_length(unsigned linked) {
    const unsigned later = ~linked & ~(all_lanes >> (lanes - 1 - static_cast<int>(threadIdx.x)));
    return (later == 0 ? lanes : static_cast<unsigned>(__ffs(static_cast<int>(later))) - 1) - threadIdx.x;
}

__device__ int column_sum(View<const std::uint8_t> image, int x, int y) {
    const int inside = clamp(x, 0, image.width - 1);
    const int outer = image.at(inside, max(y - 1, 0)) + image.at(inside, min(y + 1, image.height - 1));
    return outer + 2 * image.at(inside, y);
}

__device__ int gradient(View<const std::uint8_t> image, int x, int y) {
    return column_sum(image, x + 1, y) - column_sum(image, x - 1, y);
}

// What a pixel that is not rejected says of its match.
__device__ int vote_of(const SpeckleJob& job, int x, int y, std::int16_t value) {
    const int match = x - ((value + 15) >> 4);
    const int other = gradient(job.right, clamp(match, 0, job.width - 1), y);
    const int next = gradient(job.right, clamp(match + 1, 0, job.width - 1), y);
    const int ramp = column_sum(job.left, x + texture_reach, y) - column_sum(job.left, x - texture_reach, y);
    return texture_vote(gradient(job.left, x, y), ramp, other, next);
}

// The votes of so many lanes from this one on, which are a run that begins here.
__device__ int votes_of_run(unsigned confirmed, unsigned refuted, unsigned length) {
    const unsigned run = all_lanes >> (lanes - length) << threadIdx.x;
    return __popc(confirmed & run) - __popc(refuted & run);
}

// The regions inside each tile, joined in shared memory. Every pixel gets its root in the tile as label, and a root the
// size of the region's part there and its votes; who is no root gets size 0 and no vote.
__global__ void __launch_bounds__(tile_pixels) join_in_tiles_kernel(SpeckleJob job) {
    DISPARITYD_SHARED(std::int16_t, values, [tile_height][lanes]);
    DISPARITYD_SHARED(std::uint32_t, labels, [tile_pixels]);
    DISPARITYD_SHARED(std::uint32_t, sizes, [tile_pixels]);
    DISPARITYD_SHARED(int, votes, [tile_pixels]);
    const int lane = static_cast<int>(threadIdx.x);
    const int row = static_cast<int>(threadIdx.y);
    const int first_x = static_cast<int>(blockIdx.x) * lanes;
    const int first_y = static_cast<int>(blockIdx.y) * tile_height;
    const bool inside = first_x + lane < job.width && first_y + row < job.height;
    const int pixel = (first_y + row) * job.width + first_x + lane;
    const std::int16_t value = inside ? job.disparity[pixel] : job.invalid;
    const auto left = static_cast<std::int16_t>(__shfl_up_sync(all_lanes, int{value}, 1));
    const unsigned linked = __ballot_sync(all_lanes, static_cast<int>(lane > 0 && belong_together(job, left, value)));
    const int begin = run_begin(linked);
    const auto here = static_cast<std::uint32_t>(row * lanes + lane);
    values[row][lane] = value;
    labels[here] = static_cast<std::uint32_t>(row * lanes + begin);
    sizes[here] = 0;
    votes[here] = 0;
    const bool asked = job.min_texture > 0 && value != job.invalid;
    const int vote = asked ? vote_of(job, first_x + lane, first_y + row, value) : 0;
    const unsigned confirmed = __ballot_sync(all_lanes, static_cast<int>(vote > 0));
    const unsigned refuted = __ballot_sync(all_lanes, static_cast<int>(vote < 0));
    __syncthreads();

    const std::int16_t above = row > 0 ? values[row - 1][lane] : job.invalid;
    const std::int16_t left_above = row > 0 && lane > 0 ? values[row - 1][lane - 1] : job.invalid;
    const bool joins = belong_together(job, above, value);
    const unsigned joined = __ballot_sync(all_lanes, static_cast<int>(joins));
    // The two rows' runs have been joined one lane further left.
    const bool known = begin < lane && (joined >> (lane - 1) & 1) != 0 && belong_together(job, left_above, above);
    if (joins && !known) {
        join(labels, here, here - lanes);
    }
    __syncthreads();

    const std::uint32_t root = root_of(labels, here);
    if (begin == lane) {
        const unsigned length = run_length(linked);
        atomicAdd(&sizes[root], length);
        if (job.min_texture > 0) {
            atomicAdd(&votes[root], votes_of_run(confirmed, refuted, length));
        }
    }
    __syncthreads();
    if (inside) {
        const auto x = first_x + static_cast<int>(root) % lanes;
        const auto y = first_y + static_cast<int>(root) / lanes;
        job.labels[pixel] = static_cast<std::uint32_t>(y * job.width + x);
        job.sizes[pixel] = sizes[here];
        if (job.min_texture > 0) {
            job.votes[pixel] = votes[here];
        }
    }
}

// Two neighbouring pixels of two tiles.
struct BorderPair {
    int pixel;
    int neighbour;  // the one above, or on the left
    int before;     // steps from either to the pixel before along the border; 0: the tile begins here
};

__host__ __device__ constexpr int rows_of_pairs(int height) {
    return (height - 1) / tile_height;
}
__host__ __device__ constexpr int columns_of_pairs(int width) {
    return (width - 1) / lanes;
}
__host__ __device__ constexpr int border_pairs(int width, int height) {
    return rows_of_pairs(height) * width + columns_of_pairs(width) * height;
}

__device__ BorderPair border_pair(const SpeckleJob& job, int i) {
    const int in_rows = rows_of_pairs(job.height) * job.width;
    if (i < in_rows) {
        const int x = i % job.width;
        const int pixel = (i / job.width + 1) * tile_height * job.width + x;
        return {pixel, pixel - job.width, x % lanes == 0 ? 0 : 1};
    }
    const int y = (i - in_rows) % job.height;
    const int pixel = y * job.width + ((i - in_rows) / job.height + 1) * lanes;
    return {pixel, pixel - 1, y % tile_height == 0 ? 0 : job.width};
}

// Regions of neighbouring tiles.
__global__ void join_tiles_kernel(SpeckleJob job) {
    const int i = thread_index();
    if (i >= border_pairs(job.width, job.height)) {
        return;
    }
    const BorderPair pair = border_pair(job, i);
    const std::int16_t value = job.disparity[pair.pixel];
    const std::int16_t neighbour = job.disparity[pair.neighbour];
    if (!belong_together(job, value, neighbour)) {
        return;
    }
    if (pair.before > 0) {
        // What belongs together along the border has been joined there.
        const std::int16_t value_before = job.disparity[pair.pixel - pair.before];
        const std::int16_t neighbour_before = job.disparity[pair.neighbour - pair.before];
        if (belong_together(job, value_before, value) && belong_together(job, neighbour_before, neighbour) &&
            belong_together(job, value_before, neighbour_before)) {
            return;
        }
    }
    join(job.labels, static_cast<std::uint32_t>(pair.pixel), static_cast<std::uint32_t>(pair.neighbour));
}

// The sizes and votes of a region's parts, added to those of its root.
__global__ void add_sizes_kernel(SpeckleJob job) {
    const int i = thread_index();
    if (i >= job.width * job.height) {
        return;
    }
    const std::uint32_t size = job.sizes[i];
    if (size == 0) {
        return;
    }
    const auto part = static_cast<std::uint32_t>(i);
    const std::uint32_t root = root_of(job.labels, part);
    if (root != part) {
        atomicAdd(&job.sizes[root], size);
        if (job.min_texture > 0) {
            atomicAdd(&job.votes[root], job.votes[i]);
        }
        job.labels[part] = root;  // a shorter way for who looks later
    }
}

__device__ bool passes(const SpeckleJob& job, std::uint32_t root) {
    return job.sizes[root] >= static_cast<std::uint32_t>(job.min_size) &&
           (job.min_texture == 0 || has_texture(job.votes[root], static_cast<int>(job.sizes[root]), job.min_texture));
}

__global__ void reject_regions_kernel(SpeckleJob job) {
    const int i = thread_index();
    if (i < job.width * job.height && job.disparity[i] != job.invalid &&
        !passes(job, root_of(job.labels, static_cast<std::uint32_t>(i)))) {
        job.disparity[i] = job.invalid;
    }
}

}  // namespace

void speckle(const SpeckleJob& job, cudaStream_t stream) {
    const Shape tiles{dim3(blocks_for(job.width, lanes), blocks_for(job.height, tile_height)),
                      dim3(lanes, tile_height)};
    const Shape pixels{dim3(blocks_for(job.width * job.height, block_threads)), dim3(block_threads)};
    const int pairs = border_pairs(job.width, job.height);
    launch("speckle: join in tiles", tiles, stream, join_in_tiles_kernel, job);
    if (pairs > 0) {
        const Shape borders{dim3(blocks_for(pairs, block_threads)), dim3(block_threads)};
        launch("speckle: join tiles", borders, stream, join_tiles_kernel, job);
        launch("speckle: add sizes", pixels, stream, add_sizes_kernel, job);
    }
    launch("speckle: reject", pixels, stream, reject_regions_kernel, job);
}

}  // namespace disparityd::cuda
