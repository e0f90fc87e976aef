// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <utility>
#include <vector>

#include "kernels/parallel.h"
#include "tools/bench/alternation.h"
#include "tools/bench/our_contestant.h"

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

/// How close the steps come to what the machine could do. Measures the machine when it is first asked for a number of
/// threads.
class Roofline {
public:
    Roofline(WorkerPools& pools, std::vector<cpu::InstructionSet> instruction_sets)
        : pools_(pools), instruction_sets_(std::move(instruction_sets)) {}

    /// The rates of the machine, and a line for each step of our measurements of one pair. `options_of` has the options
    /// that a method was measured with.
    void print(const std::vector<Measurement>& measurements, const std::map<std::string, MatchOptions>& options_of,
               bool markdown, std::ostream& to);

private:
    const MachineRates& rates(std::int64_t target, int threads);

    WorkerPools& pools_;
    std::vector<cpu::InstructionSet> instruction_sets_;
    std::map<std::pair<std::int64_t, int>, MachineRates> rates_;
};

}  // namespace disparityd::bench
