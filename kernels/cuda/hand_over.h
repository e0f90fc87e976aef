// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/launch.h"

namespace disparityd::cuda {

/// Rows that a block announces together: a fence costs as much as some of them.
constexpr int rows_at_once = 4;

/// By a warp that has written what belongs to the rows before `rows`, for a warp of another block.
__device__ inline void announce_rows(int* announced, int rows) {
    __threadfence();
    __syncwarp();
    if (threadIdx.x == 0) {
        *static_cast<volatile int*>(announced) = rows;
    }
}

/// By a warp of another block: waits for so many rows and returns how many there are. What belongs to them may be read
/// from then on.
__device__ inline int wait_for_rows(const int* announced, int rows) {
    int found = *static_cast<const volatile int*>(announced);
    while (found < rows) {
        __nanosleep(100);
        found = *static_cast<const volatile int*>(announced);
    }
    __threadfence();
    return found;
}

}  // namespace disparityd::cuda
