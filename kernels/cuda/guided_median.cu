// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <utility>

#include "kernels/cuda/depth_of.h"
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

/// Puts the lesser of two places into `low`, the greater into `high`.
struct Exchange {
    std::size_t low = 0;
    std::size_t high = 0;
};

/// Calls exchange({low, high}) for each step of merge exchange, which sorts `count` values in any order (D. E. Knuth,
/// The Art of Computer Programming 3, 5.2.2, algorithm M; Batcher's sorting network).
template <typename Visit>
constexpr void merge_exchange(std::size_t count, Visit exchange) {
    std::size_t top = 1;
    while (2 * top < count) {
        top *= 2;
    }
    for (std::size_t p = top; p > 0; p /= 2) {
        std::size_t residue = 0;
        std::size_t distance = p;
        for (std::size_t q = top;; q /= 2) {
            for (std::size_t i = 0; i + distance < count; ++i) {
                if ((i & p) == residue) {
                    exchange(Exchange{i, i + distance});
                }
            }
            if (q == p) {
                break;
            }
            distance = q - p;
            residue = p;
        }
    }
}

constexpr std::size_t exchanges_to_sort(std::size_t count) {
    std::size_t exchanges = 0;
    merge_exchange(count, [&](Exchange) { ++exchanges; });
    return exchanges;
}

/// Calls visit() for the steps that the value of rank `count` / 2 depends on, the last one first.
template <std::size_t count, typename Visit>
constexpr void steps_to_the_median_backwards(Visit visit) {
    std::array<Exchange, exchanges_to_sort(count)> all{};
    std::size_t filled = 0;
    merge_exchange(count, [&](Exchange exchange) { all[filled++] = exchange; });
    std::array<bool, count> needed{};
    needed[count / 2] = true;
    for (std::size_t i = all.size(); i-- > 0;) {
        if (needed[all[i].low] || needed[all[i].high]) {
            needed[all[i].low] = needed[all[i].high] = true;
            visit(all[i]);
        }
    }
}

template <std::size_t count>
constexpr std::size_t exchanges_to_the_median() {
    std::size_t exchanges = 0;
    steps_to_the_median_backwards<count>([&](Exchange) { ++exchanges; });
    return exchanges;
}

/// Returns the exchanges, in order, after which the median of `count` values (an odd number) lies in the middle.
template <std::size_t count>
constexpr std::array<Exchange, exchanges_to_the_median<count>()> median_network() {
    std::array<Exchange, exchanges_to_the_median<count>()> network{};
    std::size_t left = network.size();
    steps_to_the_median_backwards<count>([&](Exchange exchange) { network[--left] = exchange; });
    return network;
}

/// The same as a constant.
template <std::size_t count>
inline constexpr auto exchanges_for_median = median_network<count>();

namespace {

constexpr int block_height = 8;
constexpr int tolerance = 20;  // guided_median_tolerance of kernels/steps.h, which is C++20
constexpr int like_no_other = 1024;

// Constants, because device code cannot call std::array.
template <std::size_t count>
constexpr std::size_t exchange_count = exchanges_for_median<count>.size();
template <std::size_t count, std::size_t i>
constexpr Exchange exchange_at = exchanges_for_median<count>[i];

template <std::size_t low, std::size_t high, typename Values>
__device__ void exchange(Values& values) {
    const int lesser = min(values[low], values[high]);
    values[high] = max(values[low], values[high]);
    values[low] = lesser;
}

template <std::size_t count, std::size_t... i>
__device__ int middle_of(int (&values)[count], std::index_sequence<i...>) {
    (exchange<exchange_at<count, i>.low, exchange_at<count, i>.high>(values), ...);
    return values[count / 2];
}

// A sample of step 12 and its intensity, which is like no other where the disparity is rejected.
struct Sample {
    std::int16_t disparity;
    std::int16_t intensity;
};

template <int radius>
__global__ void guided_median_kernel(GuidedMedianJob job) {
    constexpr int side = 2 * radius + 1;
    constexpr int tile_width = lanes + 2 * radius;
    constexpr int tile_height = block_height + 2 * radius;
    DISPARITYD_SHARED(Sample, tile, [tile_height][tile_width]);
    const auto invalid = static_cast<std::int16_t>((job.range.first - 1) * 16);
    const int first_x = static_cast<int>(blockIdx.x) * lanes;
    const int first_y = static_cast<int>(blockIdx.y) * block_height;
    const int column = static_cast<int>(threadIdx.x);
    const int row = static_cast<int>(threadIdx.y);
    for (int i = row * lanes + column; i < tile_width * tile_height; i += lanes * block_height) {
        const int x = clamp(first_x + i % tile_width - radius, 0, job.width - 1);
        const int y = clamp(first_y + i / tile_width - radius, 0, job.height - 1);
        const std::int16_t disparity = job.filled[static_cast<std::ptrdiff_t>(y) * job.width + x];
        const int intensity = disparity == invalid ? like_no_other : int{job.guide.at(x, y)};
        tile[i / tile_width][i % tile_width] = {disparity, static_cast<std::int16_t>(intensity)};
    }
    __syncthreads();
    const int x = first_x + column;
    const int y = first_y + row;
    if (x >= job.width || y >= job.height) {
        return;
    }
    const Sample centre = tile[row + radius][column + radius];
    int values[side * side];
    int filler = 32767;  // of samples that do not count: the least and the greatest number in turn
#pragma unroll
    for (int i = 0; i < side * side; ++i) {
        const Sample sample = tile[row + i / side][column + i % side];
        const int difference = sample.intensity - centre.intensity;
        const bool counts = difference <= tolerance && difference >= -tolerance;
        filler = counts ? filler : ~filler;
        values[i] = counts ? sample.disparity : filler;
    }
    const int middle = middle_of(values, std::make_index_sequence<exchange_count<side * side>>());
    const std::int16_t result = centre.disparity == invalid ? invalid : static_cast<std::int16_t>(middle);
    const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(y) * job.width + x;
    job.disparity[place] = result;
    if (job.depth != nullptr) {
        job.depth[place] = depth_of(job.depth_scale, invalid, result);
    }
}

}  // namespace

void guided_median(const GuidedMedianJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height)),
                      dim3(lanes, block_height)};
    if (job.size == 5) {
        launch("guided median 5", shape, stream, guided_median_kernel<2>, job);
    } else {
        launch("guided median 7", shape, stream, guided_median_kernel<3>, job);
    }
}

}  // namespace disparityd::cuda
