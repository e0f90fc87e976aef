// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/emulation/runtime_api.h"

/// The part of CUDA's textures that tests/cuda uses: images of bytes, the nearest pixel, coordinates in pixels and
/// clamped. Anything else is refused.

namespace disparityd::simt {

struct Array {
    std::size_t width, height;
    std::vector<unsigned char> pixels;
};

}  // namespace disparityd::simt

using cudaArray_t = disparityd::simt::Array*;
using cudaTextureObject_t = unsigned long long;

struct cudaChannelFormatDesc {
    std::size_t bytes;
};
template <typename T>
cudaChannelFormatDesc cudaCreateChannelDesc() {
    return {sizeof(T)};
}

enum cudaResourceType { cudaResourceTypeArray = 0 };
enum cudaTextureAddressMode { cudaAddressModeWrap = 0, cudaAddressModeClamp = 1 };
enum cudaTextureFilterMode { cudaFilterModePoint = 0, cudaFilterModeLinear = 1 };
enum cudaTextureReadMode { cudaReadModeElementType = 0, cudaReadModeNormalizedFloat = 1 };

struct cudaResourceDesc {
    cudaResourceType resType;
    struct {
        struct {
            cudaArray_t array;
        } array;
    } res;
};
struct cudaTextureDesc {
    cudaTextureAddressMode addressMode[3];
    cudaTextureFilterMode filterMode;
    cudaTextureReadMode readMode;
    int normalizedCoords;
};
struct cudaResourceViewDesc;

inline cudaError_t cudaMallocArray(cudaArray_t* array, const cudaChannelFormatDesc* format, std::size_t width,
                                   std::size_t height) {
    if (format->bytes != 1) {
        return cudaErrorInvalidValue;
    }
    *array = new disparityd::simt::Array{width, height, {}};
    (*array)->pixels.assign(width * height, disparityd::simt::settings().poison);
    return cudaSuccess;
}

inline cudaError_t cudaFreeArray(cudaArray_t array) {
    delete array;
    return cudaSuccess;
}

inline cudaError_t cudaMemcpy2DToArrayAsync(cudaArray_t to, std::size_t x, std::size_t y, const void* from,
                                            std::size_t pitch, std::size_t width, std::size_t height,
                                            cudaMemcpyKind /*kind*/, cudaStream_t stream) {
    if (x + width > to->width || y + height > to->height) {
        return cudaErrorInvalidValue;
    }
    disparityd::simt::enqueue(stream, [=] {
        for (std::size_t row = 0; row < height; ++row) {
            std::memcpy(&to->pixels[(y + row) * to->width + x], static_cast<const unsigned char*>(from) + row * pitch,
                        width);
        }
    });
    return cudaSuccess;
}

inline cudaError_t cudaCreateTextureObject(cudaTextureObject_t* texture, const cudaResourceDesc* resource,
                                           const cudaTextureDesc* reading, const cudaResourceViewDesc* /*view*/) {
    if (reading->addressMode[0] != cudaAddressModeClamp || reading->addressMode[1] != cudaAddressModeClamp ||
        reading->filterMode != cudaFilterModePoint || reading->readMode != cudaReadModeElementType ||
        reading->normalizedCoords != 0) {
        return cudaErrorInvalidValue;
    }
    *texture = reinterpret_cast<std::uintptr_t>(resource->res.array.array);
    return cudaSuccess;
}

inline cudaError_t cudaDestroyTextureObject(cudaTextureObject_t /*texture*/) {
    return cudaSuccess;
}

/// The pixel that covers (x, y), of which the first one's centre is (0.5, 0.5).
template <typename T>
T tex2D(cudaTextureObject_t texture, float x, float y) {
    static_assert(sizeof(T) == 1);
    const auto& array = *reinterpret_cast<const disparityd::simt::Array*>(static_cast<std::uintptr_t>(texture));
    const auto clamped = [](float coordinate, std::size_t size) {
        return static_cast<std::size_t>(std::clamp(std::floor(coordinate), 0.0F, static_cast<float>(size - 1)));
    };
    return array.pixels[clamped(y, array.height) * array.width + clamped(x, array.width)];
}
