// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/launch.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

constexpr unsigned block_height = 8;

template <Format format>
__device__ int luma(const std::uint8_t* row, int x) {
    if constexpr (format == Format::grey8) {
        return row[x];
    } else if constexpr (format == Format::yuyv) {
        return row[2 * x];
    } else {
        const std::uint8_t* bgr = row + 3 * x;
        return (3735 * bgr[0] + 19235 * bgr[1] + 9798 * bgr[2] + (1 << 14)) >> 15;
    }
}

struct Bgr {
    int b, g, r;
};

// ITU-R BT.601, studio range, 20 fraction bits.
__device__ Bgr from_yuv(int y, int u, int v) {
    const int luma = max(y - 16, 0) * 1220542 + (1 << 19);
    return {clamp((luma + 2116026 * (u - 128)) >> 20, 0, 255),
            clamp((luma - 852492 * (v - 128) - 409993 * (u - 128)) >> 20, 0, 255),
            clamp((luma + 1673527 * (v - 128)) >> 20, 0, 255)};
}

template <Format format>
__device__ Bgr colour(const std::uint8_t* row, int x) {
    if constexpr (format == Format::grey8) {
        return {row[x], row[x], row[x]};
    } else if constexpr (format == Format::yuyv) {
        const std::uint8_t* pair = row + 4 * (x / 2);
        return from_yuv(row[2 * x], pair[1], pair[3]);
    } else {
        return {row[3 * x], row[3 * x + 1], row[3 * x + 2]};
    }
}

template <Format format>
constexpr int pixel_bytes = format == Format::grey8  ? 1
                            : format == Format::yuyv ? 2
                                                     : 3;

// Calls sample(row, x, weight) for the source pixels of an output pixel; the weights of all inside add up to 1024.
template <Format format, typename Sample>
__device__ void for_source_pixels(const RectifyJob& job, int eye, int x, int y, Sample sample) {
    // Chosen, not indexed: an index that the compiler does not know puts the whole job into local memory.
    const std::int16_t* xy = eye == 0 ? job.xy[0] : job.xy[1];
    const std::uint16_t* fraction = eye == 0 ? job.fraction[0] : job.fraction[1];
    const std::uint8_t* source = job.raw + eye * job.eye_width * pixel_bytes<format>;
    if (xy == nullptr) {
        sample(source + (job.crop_y + y) * job.raw_stride, job.crop_x + x, 1024);
        return;
    }
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(y) * job.width + x;
    const int source_x = xy[2 * i];
    const int source_y = xy[2 * i + 1];
    const int fx = fraction[i] & 31;
    const int fy = fraction[i] >> 5 & 31;
    for (int corner = 0; corner < 4; ++corner) {
        const int dx = corner & 1;
        const int dy = corner >> 1;
        const int px = source_x + dx;
        const int py = source_y + dy;
        if (px >= 0 && px < job.eye_width && py >= 0 && py < job.raw_height) {
            sample(source + py * job.raw_stride, px, (dx == 1 ? fx : 32 - fx) * (dy == 1 ? fy : 32 - fy));
        }
    }
}

__device__ std::uint8_t rounded(int weighted_sum) {
    return static_cast<std::uint8_t>((weighted_sum + 512) >> 10);
}

template <Format format>
__global__ void rectify_kernel(RectifyJob job) {
    const int x = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y);
    const int eye = static_cast<int>(blockIdx.z);
    if (x >= job.width || y >= job.height) {
        return;
    }
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(y) * job.width + x;
    int sum = 0;
    for_source_pixels<format>(
        job, eye, x, y, [&](const std::uint8_t* row, int px, int weight) { sum += weight * luma<format>(row, px); });
    (eye == 0 ? job.out[0] : job.out[1])[i] = rounded(sum);
    std::uint8_t* const bgr = eye == 0 ? job.colour[0] : job.colour[1];
    if (bgr != nullptr) {
        Bgr all{0, 0, 0};
        for_source_pixels<format>(job, eye, x, y, [&](const std::uint8_t* row, int px, int weight) {
            const Bgr pixel = colour<format>(row, px);
            all.b += weight * pixel.b;
            all.g += weight * pixel.g;
            all.r += weight * pixel.r;
        });
        bgr[3 * i] = rounded(all.b);
        bgr[3 * i + 1] = rounded(all.g);
        bgr[3 * i + 2] = rounded(all.r);
    }
}

}  // namespace

void rectify(const RectifyJob& job, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(job.width, lanes), blocks_for(job.height, block_height), 2),
                      dim3(lanes, block_height)};
    switch (job.format) {
        case Format::grey8: launch("rectify", shape, stream, rectify_kernel<Format::grey8>, job); break;
        case Format::yuyv: launch("rectify", shape, stream, rectify_kernel<Format::yuyv>, job); break;
        case Format::bgr24: launch("rectify", shape, stream, rectify_kernel<Format::bgr24>, job); break;
    }
}

}  // namespace disparityd::cuda
