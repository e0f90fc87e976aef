// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/census_word.h"
#include "kernels/cuda/device.h"
#include "tests/cuda/census_variants.h"

namespace disparityd::test {

namespace {

constexpr int block_height = 8;

struct Words {
    std::uint64_t* of_eye[2];
    int width;
    int height;
};

cuda::Shape shape_for(int width, int height) {
    return {dim3(cuda::blocks_for(width, cuda::lanes), cuda::blocks_for(height, block_height), 2),
            dim3(cuda::lanes, block_height)};
}

// Calls word(x, y) for the thread's pixel, if it has one.
template <typename Word>
__device__ void for_own_pixel(const Words& words, Word word) {
    const int x = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    const int y = static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y);
    if (x < words.width && y < words.height) {
        std::uint64_t* out = blockIdx.z == 0 ? words.of_eye[0] : words.of_eye[1];
        out[static_cast<std::ptrdiff_t>(y) * words.width + x] = word(x, y);
    }
}

__global__ void global_memory_kernel(cuda::View<const std::uint8_t> left, cuda::View<const std::uint8_t> right,
                                     Words words) {
    const cuda::View<const std::uint8_t> image = blockIdx.z == 0 ? left : right;
    for_own_pixel(words, [&](int x, int y) {
        return cuda::census_word([&](int dx, int dy) {
            return image.at(cuda::clamp(x + dx, 0, image.width - 1), cuda::clamp(y + dy, 0, image.height - 1));
        });
    });
}

__global__ void texture_kernel(cudaTextureObject_t left, cudaTextureObject_t right, Words words) {
    const cudaTextureObject_t image = blockIdx.z == 0 ? left : right;
    for_own_pixel(words, [&](int x, int y) {
        return cuda::census_word([&](int dx, int dy) {
            return tex2D<unsigned char>(image, static_cast<float>(x + dx) + 0.5F, static_cast<float>(y + dy) + 0.5F);
        });
    });
}

}  // namespace

void census_from_global_memory(cuda::View<const std::uint8_t> left, cuda::View<const std::uint8_t> right,
                               std::uint64_t* left_words, std::uint64_t* right_words, cudaStream_t stream) {
    const Words words{{left_words, right_words}, left.width, left.height};
    cuda::launch("census from global memory", shape_for(left.width, left.height), stream, global_memory_kernel, left,
                 right, words);
}

Texture::Texture(int width, int height) {
    const cudaChannelFormatDesc format = cudaCreateChannelDesc<unsigned char>();
    cuda::check(cudaMallocArray(&array_, &format, static_cast<std::size_t>(width), static_cast<std::size_t>(height)),
                "memory for a texture");
    cudaResourceDesc resource{};
    resource.resType = cudaResourceTypeArray;
    resource.res.array.array = array_;
    cudaTextureDesc reading{};
    reading.addressMode[0] = cudaAddressModeClamp;
    reading.addressMode[1] = cudaAddressModeClamp;
    reading.filterMode = cudaFilterModePoint;
    reading.readMode = cudaReadModeElementType;
    cuda::check(cudaCreateTextureObject(&texture_, &resource, &reading, nullptr), "making a texture");
}

Texture::~Texture() {
    static_cast<void>(cudaDestroyTextureObject(texture_));
    static_cast<void>(cudaFreeArray(array_));
}

void Texture::take(cuda::View<const std::uint8_t> image, cudaStream_t stream) const {
    cuda::check(cudaMemcpy2DToArrayAsync(array_, 0, 0, image.data, static_cast<std::size_t>(image.pitch),
                                         static_cast<std::size_t>(image.width), static_cast<std::size_t>(image.height),
                                         cudaMemcpyDeviceToDevice, stream),
                "copying to a texture");
}

void census_from_textures(const Texture& left, const Texture& right, int width, int height, std::uint64_t* left_words,
                          std::uint64_t* right_words, cudaStream_t stream) {
    const Words words{{left_words, right_words}, width, height};
    cuda::launch("census from textures", shape_for(width, height), stream, texture_kernel, left.get(), right.get(),
                 words);
}

}  // namespace disparityd::test
