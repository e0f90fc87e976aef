// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "tests/emulation/simt.h"

/// What the CUDA compiler knows by itself: qualifiers, built-in variables, barriers, warp operations, atomics. Only
/// what kernels/cuda uses; the CUDA C++ programming guide is the specification.

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __launch_bounds__(...)
#define __restrict__ __restrict

#define threadIdx (::disparityd::simt::indices().thread)
#define blockIdx (::disparityd::simt::indices().block)
#define blockDim (::disparityd::simt::indices().block_size)
#define gridDim (::disparityd::simt::indices().grid_size)

using dim3 = disparityd::simt::Dim3;

struct uint2 {
    unsigned x, y;
};

// CUDA has them for device code in the global namespace.
using std::max;
using std::min;

inline void __syncthreads(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    disparityd::simt::block_barrier({file, line});
}

inline void __syncwarp(unsigned mask = 0xffffffff, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    disparityd::simt::warp_operation(disparityd::simt::Collective::sync, mask, 0, 0, {file, line});
}

namespace disparityd::simt {

template <typename T>
T shuffle(unsigned mask, T value, int source, Site site) {
    static_assert(std::is_trivially_copyable_v<T> && (sizeof(T) == 4 || sizeof(T) == 8));
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(T));
    bits = warp_operation(Collective::shuffle, mask, bits, source, site);
    std::memcpy(&value, &bits, sizeof(T));
    return value;
}

// The lane itself where the section of `width` lanes ends.
inline int section_start(int width) {
    return lane() / width * width;
}

}  // namespace disparityd::simt

template <typename T>
T __shfl_sync(unsigned mask, T value, int source, int width = 32, const char* file = __builtin_FILE(),
              int line = __builtin_LINE()) {
    const int within = ((source % width) + width) % width;
    return disparityd::simt::shuffle(mask, value, disparityd::simt::section_start(width) + within, {file, line});
}

template <typename T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                 int line = __builtin_LINE()) {
    const int source = disparityd::simt::lane() - static_cast<int>(delta);
    const bool inside = source >= disparityd::simt::section_start(width);
    return disparityd::simt::shuffle(mask, value, inside ? source : disparityd::simt::lane(), {file, line});
}

template <typename T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
    const int source = disparityd::simt::lane() + static_cast<int>(delta);
    const bool inside = source < disparityd::simt::section_start(width) + width;
    return disparityd::simt::shuffle(mask, value, inside ? source : disparityd::simt::lane(), {file, line});
}

template <typename T>
T __shfl_xor_sync(unsigned mask, T value, int lanes, int width = 32, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
    // A lane of an earlier section may be read, one of a later section may not.
    const int source = disparityd::simt::lane() ^ lanes;
    const bool inside = source < disparityd::simt::section_start(width) + width;
    return disparityd::simt::shuffle(mask, value, inside ? source : disparityd::simt::lane(), {file, line});
}

/// Blocks and threads run on one host thread, in an order in which every write is seen at once.
inline void __threadfence() {}

/// What a thread does that waits for another one: that one's turn.
inline void __nanosleep(unsigned /*nanoseconds*/, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    disparityd::simt::wait_for_others({file, line});
}

#define SIMT_WARP_OPERATION(name, operation, Result, Value)                                                            \
    inline Result name(unsigned mask, Value value, const char* file = __builtin_FILE(), int line = __builtin_LINE()) { \
        return static_cast<Result>(disparityd::simt::warp_operation(disparityd::simt::Collective::operation, mask,     \
                                                                    static_cast<unsigned>(value), 0, {file, line}));   \
    }
SIMT_WARP_OPERATION(__ballot_sync, ballot, unsigned, int)
SIMT_WARP_OPERATION(__all_sync, all, int, int)
SIMT_WARP_OPERATION(__any_sync, any, int, int)
SIMT_WARP_OPERATION(__reduce_min_sync, reduce_min, unsigned, unsigned)
SIMT_WARP_OPERATION(__reduce_max_sync, reduce_max, unsigned, unsigned)
SIMT_WARP_OPERATION(__reduce_add_sync, reduce_add, unsigned, unsigned)
SIMT_WARP_OPERATION(__reduce_and_sync, reduce_and, unsigned, unsigned)
SIMT_WARP_OPERATION(__reduce_or_sync, reduce_or, unsigned, unsigned)
#undef SIMT_WARP_OPERATION

namespace disparityd::simt {

template <typename T, typename Change>
T atomically(T* address, Change change) {
    const T before = *address;
    *address = change(before);
    atomic_done();
    return before;
}

}  // namespace disparityd::simt

template <typename T>
T atomicAdd(T* address, T value) {
    return disparityd::simt::atomically(address, [value](T before) { return static_cast<T>(before + value); });
}

template <typename T>
T atomicMin(T* address, T value) {
    return disparityd::simt::atomically(address, [value](T before) { return std::min(before, value); });
}

template <typename T>
T atomicCAS(T* address, T expected, T value) {
    return disparityd::simt::atomically(address, [=](T before) { return before == expected ? value : before; });
}
