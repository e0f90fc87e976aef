// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

constexpr int block_threads = 256;

__device__ std::uint32_t thread_index() {
    return static_cast<std::uint32_t>(blockIdx.x) * block_threads + threadIdx.x;
}

__device__ std::uint32_t pixel_count(const SpeckleJob& job) {
    return static_cast<std::uint32_t>(job.width) * static_cast<std::uint32_t>(job.height);
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

__global__ void begin_regions_kernel(SpeckleJob job) {
    const std::uint32_t i = thread_index();
    if (i < pixel_count(job)) {
        job.labels[i] = i;
        job.sizes[i] = 0;
    }
}

__global__ void join_regions_kernel(SpeckleJob job) {
    const std::uint32_t i = thread_index();
    if (i >= pixel_count(job)) {
        return;
    }
    const auto width = static_cast<std::uint32_t>(job.width);
    const std::int16_t value = job.disparity[i];
    if (i % width + 1 < width && belong_together(job, value, job.disparity[i + 1])) {
        join(job.labels, i, i + 1);
    }
    if (i + width < pixel_count(job) && belong_together(job, value, job.disparity[i + width])) {
        join(job.labels, i, i + width);
    }
}

__global__ void count_regions_kernel(SpeckleJob job) {
    const std::uint32_t i = thread_index();
    if (i < pixel_count(job)) {
        atomicAdd(&job.sizes[root_of(job.labels, i)], std::uint32_t{1});
    }
}

__global__ void reject_regions_kernel(SpeckleJob job) {
    const std::uint32_t i = thread_index();
    if (i < pixel_count(job) && job.sizes[root_of(job.labels, i)] < static_cast<std::uint32_t>(job.min_size)) {
        job.disparity[i] = job.invalid;
    }
}

}  // namespace

void speckle(const SpeckleJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width * job.height, block_threads)), dim3(block_threads)};
    launch("speckle: begin", shape, stream, begin_regions_kernel, job);
    launch("speckle: join", shape, stream, join_regions_kernel, job);
    launch("speckle: count", shape, stream, count_regions_kernel, job);
    launch("speckle: reject", shape, stream, reject_regions_kernel, job);
}

}  // namespace disparityd::cuda
