// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/launch.h"

namespace disparityd::cuda {

/// Rows that a block announces together: a fence costs as much as some of them.
constexpr int rows_at_once = 2;

/// Stores a flag that other blocks of the device poll, relaxed (PTX ISA, "Memory Consistency Model"). A volatile store
/// would have the scope of the whole system.
__device__ inline void store_flag(int* flag, int value) {
#ifdef __CUDA_ARCH__
    asm volatile("st.relaxed.gpu.global.s32 [%0], %1;" ::"l"(__cvta_generic_to_global(flag)), "r"(value) : "memory");
#else
    *static_cast<volatile int*>(flag) = value;
#endif
}

/// Loads what store_flag() has stored in another block, relaxed.
__device__ inline int load_flag(const int* flag) {
#ifdef __CUDA_ARCH__
    int value;
    asm volatile("ld.relaxed.gpu.global.s32 %0, [%1];" : "=r"(value) : "l"(__cvta_generic_to_global(flag)) : "memory");
    return value;
#else
    return *static_cast<const volatile int*>(flag);
#endif
}

/// By a warp that has written what belongs to the rows before `rows`, for a warp of another block. The barrier orders
/// the writes of all lanes before the fence of the lane that stores the flag: in the other order the fence would cover
/// that lane's writes alone.
__device__ inline void announce_rows(int* announced, int rows) {
    __syncwarp();
    __threadfence();
    if (threadIdx.x == 0) {
        store_flag(announced, rows);
    }
}

/// By a warp of another block: waits for so many rows and returns how many there are. What belongs to them may be read
/// from then on.
__device__ inline int wait_for_rows(const int* announced, int rows) {
    int found = load_flag(announced);
    while (found < rows) {
        __nanosleep(100);
        found = load_flag(announced);
    }
    __threadfence();
    return found;
}

}  // namespace disparityd::cuda
