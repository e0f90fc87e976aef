// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/packed.h"
#include "tests/cuda/minima.h"

namespace disparityd::test {

namespace {

using cuda::U16x2;

template <Minimum way>
__device__ U16x2 min_u16x2(U16x2 a, U16x2 b, U16x2 nothing) {
    if constexpr (way == Minimum::as_integers) {
        return cuda::min_u16x2_as_integers(a, b);
    } else if constexpr (way == Minimum::as_f16) {
        return cuda::min_u16x2_as_f16(a, b);
    } else {
        return cuda::min_u16x2_of_sum(a, nothing, b);
    }
}

// `nothing` is 0, which the compiler is not told.
template <Minimum way>
__global__ void minima_kernel(int rounds, U16x2 step, U16x2 nothing, U16x2* out) {
    constexpr U16x2 small = 0x3fff3fff;
    const unsigned thread = blockIdx.x * minima_threads + threadIdx.x;
    U16x2 values[minima_chains];
#pragma unroll
    for (int i = 0; i < minima_chains; ++i) {
        values[i] = ((thread + static_cast<unsigned>(i)) * 0x9e3779b9U) & small;
    }
    U16x2 other = step;
    for (int round = 0; round < rounds; ++round) {
#pragma unroll
        for (int i = 0; i < minima_chains; ++i) {
            values[i] = min_u16x2<way>(values[i], other, nothing);
        }
        other = (other + step) & small;
    }
    U16x2 all = 0;
#pragma unroll
    for (int i = 0; i < minima_chains; ++i) {
        all = all * 31 + values[i];
    }
    out[thread] = all;
}

}  // namespace

void take_minima(Minimum way, int blocks, int rounds, U16x2 step, U16x2* out, cudaStream_t stream) {
    const cuda::Shape shape{dim3(static_cast<unsigned>(blocks)), dim3(minima_threads)};
    const U16x2 nothing = 0;
    switch (way) {
        case Minimum::as_integers:
            cuda::launch("minima", shape, stream, minima_kernel<Minimum::as_integers>, rounds, step, nothing, out);
            break;
        case Minimum::as_f16:
            cuda::launch("minima", shape, stream, minima_kernel<Minimum::as_f16>, rounds, step, nothing, out);
            break;
        case Minimum::of_sum:
            cuda::launch("minima", shape, stream, minima_kernel<Minimum::of_sum>, rounds, step, nothing, out);
            break;
    }
}

}  // namespace disparityd::test
