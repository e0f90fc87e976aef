// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <cuda_runtime.h>

namespace disparityd::cuda {

/// A pitched image in device memory; `pitch` in elements.
template <typename T>
struct View {
    T* data;
    int width;
    int height;
    std::ptrdiff_t pitch;

    __device__ T* row(int y) const { return data + y * pitch; }
    __device__ T& at(int x, int y) const { return data[y * pitch + x]; }
};

}  // namespace disparityd::cuda
