// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <map>
#include <utility>
#include <vector>

#include "tools/bench/alternation.h"
#include "tools/bench/machine_rates.h"
#include "tools/bench/worker_pools.h"

namespace disparityd::bench {

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
