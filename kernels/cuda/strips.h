// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/volume.h"

namespace disparityd::cuda {

constexpr int strip_warps = 8;  // warps of a block in the sweeps

/// Neighbouring columns of a warp in the sweeps: a word of the right image serves several of them.
__host__ __device__ constexpr int columns_of_warp(int packs) {
    return packs <= 2 ? 4 : 2;
}
__host__ __device__ constexpr int columns_of_strip(int packs) {
    return strip_warps * columns_of_warp(packs);
}

/// Strips of a sweep with diagonals. They lean, and some begin beside the image.
constexpr int strips_of_sweep(int width, int height, int packs) {
    const int columns = width + height - 1;
    return (columns + columns_of_strip(packs) - 1) / columns_of_strip(packs);
}

/// The paths of a strip that its left neighbour goes on with.
constexpr int edge_paths = 3;

/// Bytes of a row of an edge.
__host__ __device__ constexpr int edge_bytes(int packs) {
    return edge_paths * pixel_bytes(packs, false);
}

}  // namespace disparityd::cuda
