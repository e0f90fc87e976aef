// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/depth_of.h"
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"
#include "kernels/fill_limit.h"

namespace disparityd::cuda {

namespace {

constexpr int block_height = 8;

__device__ std::int16_t invalid_of(const InterpolateDepthJob& job) {
    return static_cast<std::int16_t>((job.range.first - 1) * 16);
}

// The nearest measured disparity of this direction, the rejected one where there is none.
__device__ std::int16_t nearest(const InterpolateDepthJob& job, int x, int y, int dx, int dy) {
    const std::int16_t invalid = invalid_of(job);
    for (x += dx, y += dy; x >= 0 && x < job.width && y >= 0 && y < job.height; x += dx, y += dy) {
        const std::int16_t value = job.filtered[static_cast<std::ptrdiff_t>(y) * job.width + x];
        if (value != invalid) {
            return value;
        }
    }
    return invalid;
}

// Whether the right image saw something at one of the pixel's candidates.
__device__ bool mismatched(const InterpolateDepthJob& job, int x, int y) {
    const std::int16_t* winners = job.right_winner + static_cast<std::ptrdiff_t>(y) * job.width;
    for (int d = job.range.first; d < job.range.first + job.range.count; ++d) {
        const int right_x = x - d;
        if (right_x >= 0 && right_x < job.width) {
            const int seen = winners[right_x];
            if (seen >= job.range.first && seen - d <= 1 && d - seen <= 1) {
                return true;
            }
        }
    }
    return false;
}

__device__ std::int16_t background(const InterpolateDepthJob& job, int x, int y) {
    const std::int16_t left = nearest(job, x, y, -1, 0);
    const std::int16_t right = nearest(job, x, y, 1, 0);
    const std::int16_t invalid = invalid_of(job);
    return left == invalid ? right : right == invalid ? left : min(left, right);
}

// The lower one of the two middle ones of the nearest along 8 directions. A value's rank is the number of those before
// it in order; rejected ones have none.
__device__ std::int16_t middle(const InterpolateDepthJob& job, int x, int y) {
    constexpr int directions = 8;
    const std::int16_t invalid = invalid_of(job);
    std::int16_t values[directions];
    int count = 0;
#pragma unroll
    for (int i = 0; i < directions; ++i) {
        const int place = i < 4 ? i : i + 1;  // of 3 x 3 without the centre
        values[i] = nearest(job, x, y, place % 3 - 1, place / 3 - 1);
        count += values[i] != invalid ? 1 : 0;
    }
    std::int16_t result = invalid;
#pragma unroll
    for (int i = 0; i < directions; ++i) {
        int rank = 0;
#pragma unroll
        for (int j = 0; j < directions; ++j) {
            const bool first = values[j] < values[i] || (values[j] == values[i] && j < i);
            rank += values[j] != invalid && first ? 1 : 0;
        }
        result = values[i] != invalid && rank == (count - 1) / 2 ? values[i] : result;
    }
    return result;
}

__device__ int chance_at(const ConfidenceJob& job, int i) {
    const std::uint64_t word = i < 8 ? job.first_chances : i < 16 ? job.next_chances : job.last_chances;
    return static_cast<int>(word >> (8 * (i % 8)) & 255);
}

/// Step 13 for a pixel with a disparity, as calibrated_confidence().
__device__ std::uint8_t confidence_of(const ConfidenceJob& job, std::uint8_t ratio) {
    if (!job.calibrated) {
        return ratio;
    }
    const int below = ratio / 16;
    const int part = ratio % 16;
    return static_cast<std::uint8_t>((chance_at(job, below) * (16 - part) + chance_at(job, below + 1) * part + 8) / 16);
}

/// Whether step 11 has enough to fill from.
__device__ bool fills(const InterpolateDepthJob& job) {
    const auto pixels = static_cast<std::uint64_t>(job.width) * static_cast<unsigned>(job.height);
    return job.measured != nullptr && enough_to_fill_from(*job.measured, pixels);
}

__global__ void interpolate_depth_kernel(InterpolateDepthJob job) {
    const int x = static_cast<int>(blockIdx.x * lanes + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * block_height + threadIdx.y);
    if (x >= job.width || y >= job.height) {
        return;
    }
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(y) * job.width + x;
    std::int16_t disparity = job.filtered[i];
    const bool measured = disparity != invalid_of(job);
    if (!measured && fills(job)) {
        disparity = mismatched(job, x, y) ? middle(job, x, y) : background(job, x, y);
    }
    job.disparity[i] = disparity;
    job.confidence[i] = measured ? confidence_of(job.confidence_scale, job.measured_confidence[i]) : std::uint8_t{0};
    if (job.depth != nullptr) {
        job.depth[i] = depth_of(job.depth_scale, invalid_of(job), disparity);
    }
}

/// Returns the depth error of step 13 in millimetres.
__device__ std::uint16_t depth_error_of(const DepthErrorScale& scale, std::uint8_t confidence, std::int16_t disparity) {
    if (confidence == 0 || !scale.known) {
        return 0;
    }
    const std::int64_t found = disparity + scale.offset16;
    const std::int64_t n = found < max_error_disparity ? found : max_error_disparity;
    const std::int64_t millimetres = n <= 0 ? 65535 : (scale.numerator + n * n / 2) / (n * n);
    return static_cast<std::uint16_t>(millimetres < 1 ? 1 : millimetres > 65535 ? 65535 : millimetres);
}

__global__ void depth_error_kernel(DepthErrorJob job) {
    const int x = static_cast<int>(blockIdx.x * lanes + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * block_height + threadIdx.y);
    if (x < job.width && y < job.height) {
        const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(y) * job.width + x;
        job.error[i] = depth_error_of(job.scale, job.confidence[i], job.disparity[i]);
    }
}

__global__ void clear_count_kernel(std::uint32_t* count) {
    *count = 0;
}

__global__ void count_measured_kernel(CountMeasuredJob job) {
    const int x = static_cast<int>(blockIdx.x * lanes + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * block_height + threadIdx.y);
    const bool inside = x < job.width && y < job.height;
    const bool measured = inside && job.filtered[static_cast<std::ptrdiff_t>(y) * job.width + x] != job.invalid;
    const unsigned of_warp = __ballot_sync(all_lanes, static_cast<int>(measured));
    if (threadIdx.x == 0 && of_warp != 0) {
        atomicAdd(job.measured, static_cast<std::uint32_t>(__popc(of_warp)));
    }
}

}  // namespace

void count_measured(const CountMeasuredJob& job, cudaStream_t stream) {
    launch("clearing the count of measured pixels", {dim3(1), dim3(1)}, stream, clear_count_kernel, job.measured);
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    launch("counting measured pixels", shape, stream, count_measured_kernel, job);
}

void interpolate_depth(const InterpolateDepthJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    launch("interpolate and depth", shape, stream, interpolate_depth_kernel, job);
}

void depth_error(const DepthErrorJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    launch("depth error", shape, stream, depth_error_kernel, job);
}

}  // namespace disparityd::cuda
