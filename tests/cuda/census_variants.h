// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/steps.h"

/// Step 3 with the window's pixels read in other ways than kernels/cuda does: what the paper's table 3 compares.
namespace disparityd::test {

/// Every pixel of every window straight from memory.
void census_from_global_memory(cuda::View<const std::uint8_t> left, cuda::View<const std::uint8_t> right,
                               std::uint64_t* left_words, std::uint64_t* right_words, cudaStream_t stream);

/// A grey image in the layout of textures, whose coordinates are clamped to it.
class Texture {
public:
    /// Throws std::runtime_error when the device refuses.
    Texture(int width, int height);
    ~Texture();
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    void take(cuda::View<const std::uint8_t> image, cudaStream_t stream) const;
    cudaTextureObject_t get() const { return texture_; }

private:
    cudaArray_t array_ = nullptr;
    cudaTextureObject_t texture_ = 0;
};

/// Every pixel of every window through the texture units.
void census_from_textures(const Texture& left, const Texture& right, int width, int height, std::uint64_t* left_words,
                          std::uint64_t* right_words, cudaStream_t stream);

}  // namespace disparityd::test
