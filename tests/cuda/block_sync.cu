// SPDX-License-Identifier: Apache-2.0
//
// One kernel that announces rows and one that waits for them, for check_memory_order.py: it reads what nvcc makes of
// them.
#include "kernels/cuda/block_sync.h"

namespace disparityd::cuda {

extern "C" __global__ void announces(int* data, int* announced) {
    data[threadIdx.x] = 1;
    announce_rows(announced, 1);
}

extern "C" __global__ void waits(const int* data, int* announced, int* result) {
    const int rows = wait_for_rows(announced, 1);
    result[threadIdx.x] = data[threadIdx.x] + rows;
}

}  // namespace disparityd::cuda
