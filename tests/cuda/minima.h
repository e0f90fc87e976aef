// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

namespace disparityd::test {

/// The ways to take two minima of 16-bit numbers at once; see kernels/cuda/packed.h.
enum class Minimum { as_integers, as_f16, of_sum };

constexpr int minima_threads = 256;  // of a block
constexpr int minima_chains = 16;    // of a thread: independent, so that none waits for the one before

/// `rounds` times minima_chains minima in every thread; `out` gets a number for each thread that needs them all. The
/// same with each of the three ways for steps whose halves are below 0x4000.
void take_minima(Minimum way, int blocks, int rounds, std::uint32_t step, std::uint32_t* out, cudaStream_t stream);

}  // namespace disparityd::test
