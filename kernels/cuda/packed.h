// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cuda/launch.h"

namespace disparityd::cuda {

/// Two unsigned 16-bit numbers in a register. All that the kernels put into one stays below 0x7c00, where the bits of
/// an f16 have the order of the number that they are as an integer.
using U16x2 = std::uint32_t;

/// Larger than any cost, with room for a penalty.
constexpr unsigned unreachable = 0x4000;

__device__ inline U16x2 splat_u16x2(unsigned value) {
    return value * 0x10001U;
}

/// The minimum of each half, of any numbers. One instruction from 9.0 on, several before.
__device__ inline U16x2 min_u16x2_as_integers(U16x2 a, U16x2 b) {
    return __vminu2(a, b);
}

/// The same of numbers below 0x7c00. One instruction from 8.0 on.
__device__ inline U16x2 min_u16x2_as_f16(U16x2 a, U16x2 b) {
#if !defined(__CUDACC__)
    return simt::min_f16x2(a, b);
#elif __CUDA_ARCH__ >= 800
    U16x2 result;
    asm("min.f16x2 %0, %1, %2;" : "=r"(result) : "r"(a), "r"(b));
    return result;
#else
    return min_u16x2_as_integers(a, b);
#endif
}

/// The minimum of each half in one instruction, where there is one.
__device__ inline U16x2 min_u16x2(U16x2 a, U16x2 b) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800 && __CUDA_ARCH__ < 900
    return min_u16x2_as_f16(a, b);
#else
    return min_u16x2_as_integers(a, b);
#endif
}

/// min(a + b, c) of each half.
__device__ inline U16x2 min_u16x2_of_sum(U16x2 a, U16x2 b, U16x2 c) {
#if !defined(__CUDACC__) || (__CUDA_ARCH__ >= 900 && CUDART_VERSION >= 12000)
    return __viaddmin_u16x2(a, b, c);
#else
    return min_u16x2(a + b, c);  // no carry from half to half: both are small
#endif
}

/// (a + b + 1) / 2 of each half, of numbers below 0x4000.
__device__ inline U16x2 average_u16x2(U16x2 a, U16x2 b) {
    return (a + b + 0x10001U) >> 1 & 0x7fff7fffU;
}

__device__ inline unsigned min_half(U16x2 both) {
    return min(both & 0xffff, both >> 16);
}

/// A number that all lanes of a warp have, known to the compiler as such: what depends on it are no branches on which
/// lanes part.
__device__ inline int same_in_warp(int value) {
    return __shfl_sync(all_lanes, value, 0);
}

/// The least value of a warp.
__device__ inline unsigned min_of_warp(unsigned value) {
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 800
    return __reduce_min_sync(all_lanes, value);
#else
    for (int distance = lanes / 2; distance > 0; distance /= 2) {
        value = min(value, __shfl_xor_sync(all_lanes, value, distance));
    }
    return value;
#endif
}

}  // namespace disparityd::cuda
