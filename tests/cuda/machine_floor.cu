// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "kernels/cuda/packed.h"
#include "tests/cuda/machine_floor.h"

namespace disparityd::test {

namespace {

constexpr int chains = 8;  // independent of each other, so that no minimum waits for the one before
constexpr int rounds = 4096;
constexpr int blocks = 4096;
constexpr int threads = 256;

__global__ void minima_kernel(cuda::Pair* out, cuda::Pair step) {
    cuda::Pair values[chains];
    for (int i = 0; i < chains; ++i) {
        values[i] = 0x30003000 + threadIdx.x + static_cast<unsigned>(i);
    }
    cuda::Pair other = step;
    for (int round = 0; round < rounds; ++round) {
#pragma unroll
        for (int i = 0; i < chains; ++i) {
            values[i] = cuda::lesser(values[i], other);
        }
        other = values[round % 2] ^ step;
    }
    cuda::Pair all = 0;
    for (int i = 0; i < chains; ++i) {
        all ^= values[i];
    }
    out[blockIdx.x * blockDim.x + threadIdx.x] = all;
}

void demand(cudaError_t result) {
    if (result != cudaSuccess) {
        throw std::runtime_error(cudaGetErrorString(result));
    }
}

/// Median seconds of what is put on the default stream.
template <typename Operation>
double seconds_of(Operation operation) {
    cudaEvent_t begin = nullptr;
    cudaEvent_t end = nullptr;
    demand(cudaEventCreate(&begin));
    demand(cudaEventCreate(&end));
    std::vector<float> times;
    for (int i = 0; i < 21; ++i) {
        demand(cudaEventRecord(begin));
        operation();
        demand(cudaEventRecord(end));
        demand(cudaEventSynchronize(end));
        float milliseconds = 0;
        demand(cudaEventElapsedTime(&milliseconds, begin, end));
        times.push_back(milliseconds);
    }
    demand(cudaEventDestroy(begin));
    demand(cudaEventDestroy(end));
    std::nth_element(times.begin(), times.begin() + 10, times.end());
    return static_cast<double>(times[10]) / 1e3;
}

}  // namespace

MachineFloor measure_floor() {
    constexpr std::size_t bytes = std::size_t{256} << 20;
    void* from = nullptr;
    void* to = nullptr;
    demand(cudaMalloc(&from, bytes));
    demand(cudaMalloc(&to, bytes));
    MachineFloor floor;
    floor.bytes_per_second =
        2.0 * bytes / seconds_of([=] { demand(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice)); });
    const double minima = double{blocks} * threads * rounds * chains;
    floor.packed_minima_per_second =
        minima / seconds_of([=] {
            minima_kernel<<<blocks, threads>>>(static_cast<cuda::Pair*>(to), 0x12345678U & 0x3fff3fffU);
            demand(cudaGetLastError());
        });
    demand(cudaFree(from));
    demand(cudaFree(to));
    return floor;
}

}  // namespace disparityd::test
