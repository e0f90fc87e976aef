// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/roofline.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <numeric>
#include <ostream>
#include <vector>

#include "base/words.h"
#include "kernels/cpu/cache_size.h"
#include "kernels/large_buffer.h"
#include "tools/bench/report.h"
#include "tools/bench/step_work.h"
#include "tools/bench/vector_peak.h"
#include "tools/eval/means.h"

namespace disparityd::bench {
namespace {

using std::chrono::steady_clock;

/// Pieces short enough that most of them are not interrupted.
constexpr std::size_t max_piece = std::size_t{4} << 20;
constexpr std::size_t line_bytes = 64;

/// What all workers together do per second: the sum of the workers' median rates over their pieces of work.
/// `work(worker, piece)` does a piece and returns how much it was.
double rate(Parallel& workers, int pieces, FunctionRef<double(int, int)> work) {
    std::vector<double> rates(static_cast<std::size_t>(workers.workers()));
    workers.for_each(workers.workers(), [&](int worker) {
        std::vector<double> of_pieces;
        for (int piece = 0; piece < pieces; ++piece) {
            const auto start = steady_clock::now();
            const double done = work(worker, piece);
            const std::chrono::duration<double> taken = steady_clock::now() - start;
            of_pieces.push_back(done / taken.count());
        }
        rates[static_cast<std::size_t>(worker)] = eval::median(of_pieces);
    });
    return std::accumulate(rates.begin(), rates.end(), 0.0);
}

/// Memory divided among workers, each part divided into pieces of whole cache lines, all of it touched.
class Pieces {
public:
    Pieces(std::size_t bytes, int workers)
        : piece_bytes_(
              std::clamp(bytes / static_cast<std::size_t>(workers) / line_bytes * line_bytes, line_bytes, max_piece)),
          pieces_(std::max(1, static_cast<int>(bytes / piece_bytes_ / static_cast<std::size_t>(workers)))),
          buffer_(piece_bytes_ * static_cast<std::size_t>(pieces_) * static_cast<std::size_t>(workers)) {
        std::memset(buffer_.data(), 1, buffer_.size());
    }

    int pieces() const { return pieces_; }
    std::size_t piece_bytes() const { return piece_bytes_; }
    std::byte* piece(int worker, int i) const {
        return buffer_.data() + piece_bytes_ * static_cast<std::size_t>(worker * pieces_ + i % pieces_);
    }

private:
    std::size_t piece_bytes_;
    int pieces_;
    LargeBuffer buffer_;
};

double read_rate(std::size_t bytes, Parallel& workers) {
    const Pieces memory(bytes, workers.workers());
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(workers.workers()));
    return rate(workers, memory.pieces(), [&](int worker, int i) {
        const auto* words = reinterpret_cast<const std::uint64_t*>(memory.piece(worker, i));
        std::uint64_t sum[8] = {};
        for (std::size_t k = 0; k < memory.piece_bytes() / sizeof(std::uint64_t); k += 8) {
            for (std::size_t j = 0; j < 8; ++j) {
                sum[j] += words[k + j];
            }
        }
        sums[static_cast<std::size_t>(worker)] += std::accumulate(sum, sum + 8, std::uint64_t{0});
        return static_cast<double>(memory.piece_bytes());
    });
}

/// `rounds`: how often the same bytes are copied.
double copy_rate(std::size_t bytes, int rounds, Parallel& workers) {
    const Pieces from(bytes, workers.workers());
    const Pieces to(bytes, workers.workers());
    return rate(workers, from.pieces() * rounds, [&](int worker, int i) {
        std::memcpy(to.piece(worker, i), from.piece(worker, i), from.piece_bytes());
        return static_cast<double>(from.piece_bytes());
    });
}

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

MachineRates measure_machine(std::int64_t target, Parallel& workers) {
    const std::size_t cache = cpu::last_level_cache_bytes();
    const std::size_t beyond_cache = std::clamp(4 * cache, std::size_t{64} << 20, std::size_t{512} << 20);
    constexpr int cached_rounds = 16, operation_pieces = 40;
    return {read_rate(beyond_cache, workers), copy_rate(beyond_cache, 1, workers),
            copy_rate(cache / 4, cached_rounds, workers),
            rate(workers, operation_pieces, [&](int, int) { return do_byte_operations(target); })};
}

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
