// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/path_costs.h"

namespace disparityd::cuda {

namespace {

constexpr int block_lines = 4;  // warps of a block: neighbouring lines read the same words of the right image

struct Step {
    int dx, dy;
};

// To the left; down, up; along the diagonals.
__device__ Step step_of(int direction) {
    if (direction == 0) {
        return {-1, 0};
    }
    const int dx = direction < 3 ? 0 : direction == 3 || direction == 6 ? 1 : -1;
    return {dx, direction % 2 == 1 ? 1 : -1};
}

// A warp for each line of each direction. Diagonals that leave the image at a side enter it again at the other, as a
// new line: all have the image's height.
template <int packs>
__global__ void __launch_bounds__(block_lines* lanes) paths_kernel(PathsJob job) {
    const int direction = static_cast<int>(blockIdx.y);
    const int line = static_cast<int>(blockIdx.x * block_lines + threadIdx.y);
    const int width = job.image.width;
    const int height = job.image.height;
    const Step step = step_of(direction);
    const bool along_row = step.dy == 0;
    if (line >= (along_row ? height : width)) {
        return;
    }
    int x = along_row ? width - 1 : line;
    int pixel = (along_row ? line : step.dy > 0 ? 0 : height - 1) * width + x;
    const int pixels = along_row ? width : height;
    std::uint8_t* volume = job.volumes + static_cast<std::size_t>(direction) * volume_bytes<packs>(width, height);
    Costs<packs> idle;
    idle_slots<packs>(job.range.count, idle);
    PathCosts<packs> path;
    bool begins = true;
    int intensity_before = 0;
    for (int i = 0; i < pixels; ++i) {
        Costs<packs> costs;
        census_costs<packs>(job.words.left[pixel], job.words.right + pixel, width, x, job.range.first, costs);
        const int intensity = job.image.data[pixel];
        if (begins) {
            begin_path<packs>(costs, idle, path);
        } else {
            const int p2 = adapted_p2(job.p1, job.p2, job.adaptive_p2, intensity, intensity_before);
            continue_path<packs>(costs, idle, job.p1, p2, path);
        }
        store_path<packs>(volume + static_cast<std::size_t>(pixel) * pixel_bytes(packs), path);
        intensity_before = intensity;
        x += step.dx;
        pixel += step.dy * width + step.dx;
        begins = x < 0 || x >= width;
        if (begins) {
            const int across = x < 0 ? width : -width;
            x += across;
            pixel += across;
        }
    }
}

}  // namespace

std::size_t volume_bytes(int width, int height, int disparities) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
           static_cast<std::size_t>(pixel_bytes(packs_for(disparities)));
}

std::size_t paths_bytes(int width, int height, int disparities, int paths) {
    return static_cast<std::size_t>(paths - 1) * volume_bytes(width, height, disparities);
}

void aggregate(const PathsJob& job, cudaStream_t stream) {
    const int most_lines = job.image.width > job.image.height ? job.image.width : job.image.height;
    const Shape shape{dim3(blocks_for(most_lines, block_lines), static_cast<unsigned>(job.paths - 1)),
                      dim3(lanes, block_lines)};
    with_packs(job.range.count,
               [&](auto packs) { launch("aggregate", shape, stream, paths_kernel<decltype(packs)::value>, job); });
}

}  // namespace disparityd::cuda
