// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/parallel.h"

namespace disparityd::bench {

/// What this machine can do at most, measured.
struct MachineRates {
    double read_bytes_per_second = 0;         ///< from memory
    double copy_bytes_per_second = 0;         ///< memory to memory, each byte counted once
    double cached_copy_bytes_per_second = 0;  ///< the same within the last-level cache
    double byte_operations_per_second = 0;    ///< of an instruction set

    /// Seconds that it takes at least to move as many bytes, half of them read, half written. `in_cache`: what is
    /// written fits the last-level cache and is read from there.
    double seconds_to_move(double bytes, bool in_cache) const {
        return bytes / 2 / (in_cache ? cached_copy_bytes_per_second : copy_bytes_per_second);
    }
};

/// With all workers together. Takes about half a second.
MachineRates measure_machine(std::int64_t target, Parallel& workers);

}  // namespace disparityd::bench
