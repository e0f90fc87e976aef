// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/bench/plain_variants.h"

namespace disparityd::bench {

/// One path in vector instructions, written the obvious way, with the least cost of a pixel found in two ways. For any
/// number of candidates that is a multiple of 16.
struct VectorPaths {
    ContinuePath tree = nullptr;          ///< halves of the vector against each other, log2(lanes) times
    ContinuePath lane_by_lane = nullptr;  ///< one lane after the other
};

/// For an instruction set of Highway; empty pointers where the kernels are not built for it.
VectorPaths vector_paths(std::int64_t target);

}  // namespace disparityd::bench
