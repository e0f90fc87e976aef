// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cuda_runtime.h>

/// What CUDA writes in no other language's grammar, for sources that a plain C++ compiler takes too: the tests run them
/// on the processor, under a cuda_runtime.h of their own. For .cu files alone; C++17.

#ifdef __CUDACC__
/// An array in shared memory: DISPARITYD_SHARED(float, tile, [8][9]);
#define DISPARITYD_SHARED(type, name, extents) __shared__ type name extents
#else
#define DISPARITYD_SHARED(type, name, extents) auto& name = ::disparityd::simt::shared<type extents>([] {})
#endif

namespace disparityd::cuda {

constexpr int lanes = 32;
constexpr unsigned all_lanes = 0xffffffff;

/// Throws std::runtime_error when a launch was refused; `kernel` is its name in the message.
void check_launch(const char* kernel);

struct Shape {
    dim3 grid;
    dim3 block;
};

template <typename... Parameters, typename... Arguments>
void launch(const char* name, Shape shape, cudaStream_t stream, void (*kernel)(Parameters...), Arguments... arguments) {
#ifdef __CUDACC__
    kernel<<<shape.grid, shape.block, 0, stream>>>(arguments...);
#else
    simt::enqueue(stream, [=] { simt::run(shape.grid, shape.block, 0, [=] { kernel(arguments...); }); });
#endif
    check_launch(name);
}

constexpr unsigned blocks_for(int count, int size) {
    return static_cast<unsigned>((count + size - 1) / size);
}

/// Asks for a line of the device's memory, which is read soon: what waits for it is no thread.
__device__ inline void prefetch(const void* address) {
#ifdef __CUDA_ARCH__
    asm volatile("prefetch.global.L1 [%0];" ::"l"(__cvta_generic_to_global(address)));
#else
    static_cast<void>(address);
#endif
}

__device__ inline int clamp(int value, int least, int most) {
    return value < least ? least : value > most ? most : value;
}

}  // namespace disparityd::cuda
