// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/census_word.h"
#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

constexpr int tile_side = 32;  // pixels of a block
constexpr int tile_width = tile_side + 2 * census_radius_x;
constexpr int tile_height = tile_side + 2 * census_radius_y;
constexpr int block_height = 8;  // threads; each computes every eighth row of the tile

// For GradientWord, which holds what belongs to three rows.
constexpr int gradient_rows = tile_side + 2;
constexpr int gradient_tile_width = tile_side + 2 * gradient_census_radius_x;
template <int row_step>
constexpr int gradient_tile_height = gradient_rows + 2 * gradient_census_radius_y* row_step;

// Reads the tile of a block, its border too, from an image with its border replicated.
template <int width, int height>
__device__ void read_tile(View<const std::uint8_t> image, int first_x, int first_y, int thread,
                          std::uint8_t (&tile)[height][width]) {
    constexpr int border_x = (width - tile_side) / 2;
    constexpr int border_y = (height - tile_side) / 2;
    for (int i = thread; i < height * width; i += tile_side * block_height) {
        const int column = i % width;
        const int row = i / width;
        tile[row][column] = image.at(clamp(first_x + column - border_x, 0, image.width - 1),
                                     clamp(first_y + row - border_y, 0, image.height - 1));
    }
}

// A tile with its border is read once, 40 x 38 pixels for 32 x 32 words, and compared in shared memory.
__global__ void census_kernel(View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint64_t* left_words,
                              std::uint64_t* right_words) {
    DISPARITYD_SHARED(std::uint8_t, tile, [tile_height][tile_width]);
    const View<const std::uint8_t> image = blockIdx.z == 0 ? left : right;
    std::uint64_t* words = blockIdx.z == 0 ? left_words : right_words;
    const int first_x = static_cast<int>(blockIdx.x) * tile_side;
    const int first_y = static_cast<int>(blockIdx.y) * tile_side;
    const int thread = static_cast<int>(threadIdx.y * tile_side + threadIdx.x);
    read_tile<tile_width, tile_height>(image, first_x, first_y, thread, tile);
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

// Three rows of a tile of parts of words, as words that hold what belongs to three rows.
__device__ void write_gradient_words(const std::uint32_t (&census)[gradient_rows][tile_side],
                                     const std::uint8_t (&gradients)[gradient_rows][tile_side], int first_x,
                                     int first_y, int width, int height, GradientWord* words) {
    const int column = static_cast<int>(threadIdx.x);
    const int x = first_x + column;
    for (int row = static_cast<int>(threadIdx.y); row < tile_side; row += block_height) {
        const int y = first_y + row;
        if (x < width && y < height) {
            GradientWord word{};
#pragma unroll
            for (int i = 0; i < 3; ++i) {
                word.census[i] = census[row + i][column];
                word.gradients |= static_cast<std::uint32_t>(gradients[row + i][column]) << (8 * i);
            }
            words[static_cast<std::ptrdiff_t>(y) * width + x] = word;
        }
    }
}

// The same for the other cost. What belongs to a row of the tile, and to the ones above and below the tile, is computed
// once and written into the words of three rows.
__global__ void census_gradient_kernel(View<const std::uint8_t> left, View<const std::uint8_t> right,
                                       std::uint64_t* left_words, std::uint64_t* right_words) {
    DISPARITYD_SHARED(std::uint8_t, tile, [gradient_tile_height<1>][gradient_tile_width]);
    DISPARITYD_SHARED(std::uint32_t, census, [gradient_rows][tile_side]);
    DISPARITYD_SHARED(std::uint8_t, gradients, [gradient_rows][tile_side]);
    const View<const std::uint8_t> image = blockIdx.z == 0 ? left : right;
    auto* words = reinterpret_cast<GradientWord*>(blockIdx.z == 0 ? left_words : right_words);
    const int first_x = static_cast<int>(blockIdx.x) * tile_side;
    const int first_y = static_cast<int>(blockIdx.y) * tile_side;
    const int thread = static_cast<int>(threadIdx.y * tile_side + threadIdx.x);
    read_tile<gradient_tile_width, gradient_tile_height<1>>(image, first_x, first_y, thread, tile);
    __syncthreads();
    const int column = static_cast<int>(threadIdx.x);
    for (int row = static_cast<int>(threadIdx.y); row < gradient_rows; row += block_height) {
        // Above and below the image its outermost rows count again, not what a window would see there.
        const int tile_row = clamp(first_y + row - 1, 0, image.height - 1) - first_y + 1 + gradient_census_radius_y;
        const auto read = [&](int dx, int dy) { return tile[tile_row + dy][column + gradient_census_radius_x + dx]; };
        census[row][column] = gradient_census_bits<1>(read, read(0, 0));
        gradients[row][column] = gradient_byte<1>(read);
    }
    __syncthreads();
    write_gradient_words(census, gradients, first_x, first_y, image.width, image.height, words);
}

// The same at noise levels, with a tile of the smoothed image beside that of the image.
template <int coarseness>
__global__ void noisy_census_kernel(NoisyImage left, NoisyImage right, std::uint64_t* left_words,
                                    std::uint64_t* right_words) {
    constexpr int image_height = gradient_tile_height<coarseness>;
    constexpr int smoothed_height = gradient_rows + 2;
    constexpr int smoothed_width = tile_side + 2;
    DISPARITYD_SHARED(std::uint8_t, tile, [image_height][gradient_tile_width]);
    DISPARITYD_SHARED(std::uint8_t, smoothed, [smoothed_height][smoothed_width]);
    DISPARITYD_SHARED(std::uint32_t, census, [gradient_rows][tile_side]);
    DISPARITYD_SHARED(std::uint8_t, gradients, [gradient_rows][tile_side]);
    const View<const std::uint8_t> image = blockIdx.z == 0 ? left.image : right.image;
    const View<const std::uint8_t> smoothed_image = blockIdx.z == 0 ? left.smoothed : right.smoothed;
    const int first_x = static_cast<int>(blockIdx.x) * tile_side;
    const int first_y = static_cast<int>(blockIdx.y) * tile_side;
    const int thread = static_cast<int>(threadIdx.y * tile_side + threadIdx.x);
    read_tile<gradient_tile_width, image_height>(image, first_x, first_y, thread, tile);
    read_tile<smoothed_width, smoothed_height>(smoothed_image, first_x, first_y, thread, smoothed);
    __syncthreads();
    const int column = static_cast<int>(threadIdx.x);
    for (int row = static_cast<int>(threadIdx.y); row < gradient_rows; row += block_height) {
        const int from_tile = clamp(first_y + row - 1, 0, image.height - 1) - first_y + 1;
        const auto read = [&](int dx, int dy) {
            return tile[from_tile + gradient_census_radius_y * coarseness + dy][column + gradient_census_radius_x + dx];
        };
        const auto read_smoothed = [&](int dx, int dy) { return smoothed[from_tile + 1 + dy][column + 1 + dx]; };
        census[row][column] = gradient_census_bits<coarseness>(read, read_smoothed(0, 0) - coarseness);
        gradients[row][column] = gradient_byte<coarseness>(read_smoothed);
    }
    __syncthreads();
    write_gradient_words(census, gradients, first_x, first_y, image.width, image.height,
                         reinterpret_cast<GradientWord*>(blockIdx.z == 0 ? left_words : right_words));
}

// The smoothed image of step 3.
__global__ void smooth_kernel(View<const std::uint8_t> left, View<const std::uint8_t> right,
                              std::uint8_t* smoothed_left, std::uint8_t* smoothed_right) {
    const View<const std::uint8_t> image = blockIdx.z == 0 ? left : right;
    std::uint8_t* const smoothed = blockIdx.z == 0 ? smoothed_left : smoothed_right;
    const int x = static_cast<int>(blockIdx.x * tile_side + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * block_height + threadIdx.y);
    if (x >= image.width || y >= image.height) {
        return;
    }
    int sum = 8;
#pragma unroll
    for (int dy = -1; dy <= 1; ++dy) {
#pragma unroll
        for (int dx = -1; dx <= 1; ++dx) {
            const int weight = (dx == 0 ? 2 : 1) * (dy == 0 ? 2 : 1);
            sum += weight * image.at(clamp(x + dx, 0, image.width - 1), clamp(y + dy, 0, image.height - 1));
        }
    }
    smoothed[static_cast<std::ptrdiff_t>(y) * image.width + x] = static_cast<std::uint8_t>(sum / 16);
}

}  // namespace

cudaError_t code_for_device() {
    cudaFuncAttributes attributes;
    const cudaError_t found = cudaFuncGetAttributes(&attributes, census_kernel);
    static_cast<void>(cudaGetLastError());
    return found;
}

void census(Cost cost, View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint64_t* left_words,
            std::uint64_t* right_words, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(left.width, tile_side), blocks_for(left.height, tile_side), 2),
                      dim3(tile_side, block_height)};
    launch("census", shape, stream, cost == Cost::census_9x7 ? census_kernel : census_gradient_kernel, left, right,
           left_words, right_words);
}

void smooth(View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint8_t* smoothed_left,
            std::uint8_t* smoothed_right, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(left.width, tile_side), blocks_for(left.height, block_height), 2),
                      dim3(tile_side, block_height)};
    launch("smooth", shape, stream, smooth_kernel, left, right, smoothed_left, smoothed_right);
}

void noisy_census(int coarseness, const NoisyImage& left, const NoisyImage& right, std::uint64_t* left_words,
                  std::uint64_t* right_words, cudaStream_t stream) {
    const Shape shape{dim3(blocks_for(left.image.width, tile_side), blocks_for(left.image.height, tile_side), 2),
                      dim3(tile_side, block_height)};
    launch("noisy census", shape, stream, coarseness == 1 ? noisy_census_kernel<1> : noisy_census_kernel<2>, left,
           right, left_words, right_words);
}

}  // namespace disparityd::cuda
