// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/census_word.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

constexpr int tile_side = 32;  // pixels of a block
constexpr int tile_width = tile_side + 2 * census_radius_x;
constexpr int tile_height = tile_side + 2 * census_radius_y;
constexpr int block_height = 8;  // threads; each computes every eighth row of the tile

// A tile with its border is read once, 40 x 38 pixels for 32 x 32 words, and compared in shared memory.
__global__ void census_kernel(View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint64_t* left_words,
                              std::uint64_t* right_words) {
    DISPARITYD_SHARED(std::uint8_t, tile, [tile_height][tile_width]);
    const View<const std::uint8_t> image = blockIdx.z == 0 ? left : right;
    std::uint64_t* words = blockIdx.z == 0 ? left_words : right_words;
    const int first_x = static_cast<int>(blockIdx.x) * tile_side;
    const int first_y = static_cast<int>(blockIdx.y) * tile_side;
    const int thread = static_cast<int>(threadIdx.y * tile_side + threadIdx.x);
    for (int i = thread; i < tile_height * tile_width; i += tile_side * block_height) {
        const int column = i % tile_width;
        const int row = i / tile_width;
        tile[row][column] = image.at(clamp(first_x + column - census_radius_x, 0, image.width - 1),
                                     clamp(first_y + row - census_radius_y, 0, image.height - 1));
    }
    __syncthreads();
    const int column = static_cast<int>(threadIdx.x);
    const int x = first_x + column;
    for (int row = static_cast<int>(threadIdx.y); row < tile_side; row += block_height) {
        const int y = first_y + row;
        if (x < image.width && y < image.height) {
            words[static_cast<std::ptrdiff_t>(y) * image.width + x] = census_word(
                [&](int dx, int dy) { return tile[row + census_radius_y + dy][column + census_radius_x + dx]; });
        }
    }
}

}  // namespace

cudaError_t code_for_device() {
    cudaFuncAttributes attributes;
    const cudaError_t found = cudaFuncGetAttributes(&attributes, census_kernel);
    static_cast<void>(cudaGetLastError());
    return found;
}

void census(View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint64_t* left_words,
            std::uint64_t* right_words, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(left.width, tile_side), blocks_for(left.height, tile_side), 2),
                      dim3(tile_side, block_height)};
    launch("census", shape, stream, census_kernel, left, right, left_words, right_words);
}

}  // namespace disparityd::cuda
