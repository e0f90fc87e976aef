// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/roofline.h"

#include <algorithm>
#include <ostream>

#include "base/words.h"
#include "kernels/cpu/cache_size.h"
#include "tools/bench/report.h"
#include "tools/bench/step_work.h"
#include "tools/eval/median.h"

namespace disparityd::bench {
namespace {

using tools::fixed;

std::string machine_line(const std::string& isa, int threads, const MachineRates& rates) {
    return isa + ", " + base::counted(static_cast<std::uint64_t>(threads), "thread") + ": read " +
           fixed(rates.read_bytes_per_second / 1e9, 1) + " GB/s, copy " + fixed(rates.copy_bytes_per_second / 1e9, 1) +
           " GB/s (in the last-level cache " + fixed(rates.cached_copy_bytes_per_second / 1e9, 1) + "), " +
           fixed(rates.byte_operations_per_second / 1e9, 0) + " thousand million operations on bytes per second";
}

std::vector<std::string> cells(const Measurement& one, const std::string& step, const StepWork& work,
                               const MachineRates& rates) {
    const double ms = eval::median(one.step_ms.at(step));
    const bool in_cache = work.volume_bytes < static_cast<double>(cpu::last_level_cache_bytes());
    const double by_bytes = 1e3 * rates.seconds_to_move(work.bytes, in_cache);
    const double by_operations = 1e3 * work.byte_operations / rates.byte_operations_per_second;
    const double bound = std::max(by_bytes, by_operations);
    return {one.name + " " + step,
            one.isa,
            std::to_string(one.threads),
            fixed(ms, 3),
            fixed(work.bytes / 1e6, 1),
            fixed(by_bytes, 3),
            fixed(work.byte_operations / 1e6, 0),
            fixed(by_operations, 3),
            by_bytes > by_operations ? "bytes" : "operations",
            fixed(100 * bound / ms, 0)};
}

}  // namespace

void Roofline::print(const std::vector<Measurement>& measurements,
                     const std::map<std::string, MatchOptions>& options_of, bool markdown, std::ostream& to) {
    tools::Table table({"step", "isa", "threads", "ms median", "MB moved", "ms by bytes", "M byte operations",
                        "ms by operations", "bound", "bound / time %"});
    std::map<std::string, std::string> machine;
    for (const Measurement& one : measurements) {
        const auto set = std::find_if(instruction_sets_.begin(), instruction_sets_.end(),
                                      [&](const cpu::InstructionSet& candidate) { return candidate.name == one.isa; });
        const auto options = options_of.find(one.name);
        if (set == instruction_sets_.end() || options == options_of.end()) {
            continue;
        }
        const MachineRates& found = rates(set->target, one.threads);
        machine[one.isa + std::to_string(one.threads)] = machine_line(one.isa, one.threads, found);
        for (const std::string& step : one.steps) {
            if (const auto work = step_work(step, options->second, static_cast<double>(one.width) * one.height)) {
                table.add(cells(one, step, *work, found));
            }
        }
    }
    if (machine.empty()) {
        return;
    }
    to << '\n';
    for (const auto& [key, line] : machine) {
        to << (markdown ? "- " : "") << line << '\n';
    }
    to << (markdown ? "\n" : "");
    bench::print(table, markdown, to);
}

const MachineRates& Roofline::rates(std::int64_t target, int threads) {
    const auto [entry, inserted] = rates_.try_emplace({target, threads});
    if (inserted) {
        pipeline::WorkerPool& pool = pools_.with(threads);
        const pipeline::WorkerPool::ComputeSlot slot(pool);
        entry->second = measure_machine(target, pool);
    }
    return entry->second;
}

}  // namespace disparityd::bench
